# What users of target ipc see: its names, versions and include directories; and
# the static library beside the shared one.  Included where ipc is made.

# Programs that were linked with CMU IPC 3.9.1 ask for libipc.so.1.
set_target_properties(ipc PROPERTIES
    OUTPUT_NAME ipc
    VERSION 1.${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    SOVERSION 1
    C_VISIBILITY_PRESET hidden
    POSITION_INDEPENDENT_CODE ON)

# Both <ipc/ipc.h> and "ipc.h" are found.
function(ipc_describe_users target)
    target_include_directories(${target} INTERFACE
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include/ipc>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/ipc>)
    add_library(ipc::${target} ALIAS ${target})
endfunction()

ipc_describe_users(ipc)

get_target_property(IPC_LIBRARY_TYPE ipc TYPE)
if(WIN32 AND IPC_LIBRARY_TYPE STREQUAL "SHARED_LIBRARY")
    # A DLL shows what a list names, and who uses its data has to know that it is one.
    target_sources(ipc PRIVATE ${PROJECT_SOURCE_DIR}/Windows/ipc.def)
    target_compile_definitions(ipc INTERFACE IPC_DLL)
endif()
if(IPC_LIBRARY_TYPE STREQUAL "SHARED_LIBRARY")
    add_library(ipc_static STATIC $<TARGET_OBJECTS:ipc> $<TARGET_OBJECTS:ipc_core>)
    set_target_properties(ipc_static PROPERTIES
        OUTPUT_NAME ipc
        LINKER_LANGUAGE C)
    if(MSVC)
        set_target_properties(ipc_static PROPERTIES OUTPUT_NAME ipc_static) # ipc.lib is the DLL's
    endif()
    target_link_libraries(ipc_static PUBLIC ${IPC_SYSTEM_LIBRARIES})
    ipc_describe_users(ipc_static)
    set(IPC_ARCHIVE ipc_static)
else()
    # The shared layers are in the archive; users need no more than the system's libraries.
    set_target_properties(ipc PROPERTIES INTERFACE_LINK_LIBRARIES "${IPC_SYSTEM_LIBRARIES}")
    set(IPC_ARCHIVE ipc)
endif()

# An archive does not hide what is hidden: names of the library's own functions
# would clash with those of a program.  Merging its objects into one and making
# the hidden names local there prevents that, where the tools can.
if(CMAKE_OBJCOPY AND CMAKE_SYSTEM_NAME STREQUAL "Linux"
        AND NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION)
    add_custom_command(TARGET ${IPC_ARCHIVE} POST_BUILD
        COMMAND ${CMAKE_COMMAND}
            -D "ARCHIVE=$<TARGET_FILE:${IPC_ARCHIVE}>"
            -D "LINKER=${CMAKE_LINKER}" -D "OBJCOPY=${CMAKE_OBJCOPY}" -D "AR=${CMAKE_AR}"
            -P ${PROJECT_SOURCE_DIR}/cmake/hide_symbols.cmake
        VERBATIM)
endif()
