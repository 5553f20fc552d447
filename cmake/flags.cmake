# Flags of everything that is built here and of nothing that links with it.

set(CMAKE_C_STANDARD 99)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(ipc_build_flags INTERFACE)
target_compile_options(ipc_build_flags INTERFACE
    $<$<C_COMPILER_ID:GNU,Clang,AppleClang>:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion>
    $<$<AND:$<BOOL:${IPC_WERROR}>,$<C_COMPILER_ID:GNU,Clang,AppleClang>>:-Werror>)
if(MINGW)
    # C99's printf, not that of Windows; and isnan and the like are macros that warn.
    target_compile_definitions(ipc_build_flags INTERFACE __USE_MINGW_ANSI_STDIO=1)
    target_compile_options(ipc_build_flags INTERFACE -Wno-float-conversion)
endif()
if(MSVC)
    target_compile_definitions(ipc_build_flags INTERFACE
        _CRT_SECURE_NO_WARNINGS _CRT_NONSTDC_NO_WARNINGS)
endif()
if(IPC_SANITIZE)
    target_compile_options(ipc_build_flags INTERFACE
        -fsanitize=${IPC_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(ipc_build_flags INTERFACE -fsanitize=${IPC_SANITIZE})
endif()
