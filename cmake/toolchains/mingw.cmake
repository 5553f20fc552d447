# 64-bit Windows by mingw-w64; wine runs the programs.  Debian: gcc-mingw-w64-x86-64-posix, wine.
# Elsewhere than on Windows, set WINEPREFIX to a folder of its own for a while.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(TRIPLE x86_64-w64-mingw32)
set(CMAKE_C_COMPILER ${TRIPLE}-gcc)
set(CMAKE_RC_COMPILER ${TRIPLE}-windres)
set(CMAKE_FIND_ROOT_PATH /usr/${TRIPLE})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR wine)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static) # no DLL of the compiler's besides libipc's
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static)
set(IPC_OWN_CMOCKA ON CACHE BOOL "")
