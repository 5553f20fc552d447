# Flags of everything that is built here and of nothing that links with it.

set(CMAKE_C_STANDARD 99)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(ipc_build_flags INTERFACE)
target_compile_options(ipc_build_flags INTERFACE
    $<$<C_COMPILER_ID:GNU,Clang,AppleClang>:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion>
    $<$<AND:$<BOOL:${IPC_WERROR}>,$<C_COMPILER_ID:GNU,Clang,AppleClang>>:-Werror>)
if(IPC_SANITIZE)
    target_compile_options(ipc_build_flags INTERFACE
        -fsanitize=${IPC_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(ipc_build_flags INTERFACE -fsanitize=${IPC_SANITIZE})
endif()
