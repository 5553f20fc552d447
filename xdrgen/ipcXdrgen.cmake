# ipc_xdrgen(target specification... [LANGUAGE c|c++] [DIRECTORY folder] [OPTIONS option...])
#
# Makes of each specification NAME.xdr the header NAME.xdr.h before target is
# compiled, and lets target include it by that name.  The default language is
# C, whose headers C++ can include as well.  DIRECTORY says where the headers
# are written (by default to a folder of the target's own in the build
# directory); OPTIONS are further options of xdrgen, such as --register.
function(ipc_xdrgen target)
    cmake_parse_arguments(xdrgen "" "LANGUAGE;DIRECTORY" "OPTIONS" ${ARGN})
    if(NOT TARGET ${target})
        message(FATAL_ERROR "ipc_xdrgen: there is no target ${target}")
    endif()
    if(NOT xdrgen_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "ipc_xdrgen: no specification is given for ${target}")
    endif()
    if(NOT xdrgen_LANGUAGE)
        set(xdrgen_LANGUAGE c)
    endif()
    if(NOT xdrgen_DIRECTORY)
        set(xdrgen_DIRECTORY xdrgen/${target})
    endif()
    get_filename_component(folder "${xdrgen_DIRECTORY}" ABSOLUTE
        BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
    file(MAKE_DIRECTORY "${folder}")
    foreach(specification IN LISTS xdrgen_UNPARSED_ARGUMENTS)
        get_filename_component(name "${specification}" NAME)
        get_filename_component(input "${specification}" ABSOLUTE
            BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
        set(header "${folder}/${name}.h")
        add_custom_command(OUTPUT "${header}"
            COMMAND ipc::xdrgen --lang=${xdrgen_LANGUAGE} ${xdrgen_OPTIONS} "${input}" "${header}"
            DEPENDS "${input}" ipc::xdrgen
            COMMENT "Generating ${name}.h"
            VERBATIM)
        target_sources(${target} PRIVATE "${header}")
    endforeach()
    target_include_directories(${target} PRIVATE "${folder}")
endfunction()
