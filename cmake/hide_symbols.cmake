# Rewrites the static library ARCHIVE so that only symbols of default visibility
# are global.  Run as a script, with LINKER, OBJCOPY and AR.

set(object "${ARCHIVE}.o")

function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        list(GET ARGN 0 tool)
        file(REMOVE "${object}" "${ARCHIVE}")
        message(FATAL_ERROR "${tool} failed on ${ARCHIVE}: ${status}")
    endif()
endfunction()

run(${LINKER} -r -o ${object} --whole-archive ${ARCHIVE})
run(${OBJCOPY} --localize-hidden ${object})
file(REMOVE "${ARCHIVE}")
run(${AR} qcs ${ARCHIVE} ${object})
file(REMOVE "${object}")
