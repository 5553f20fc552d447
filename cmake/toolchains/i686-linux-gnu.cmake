# 32 bits, least significant byte first; x86-64 runs it by itself.  Debian: gcc-i686-linux-gnu.
set(CMAKE_SYSTEM_PROCESSOR i686)
set(TRIPLE i686-linux-gnu)
set(RUNNER /usr/${TRIPLE}/lib/ld-linux.so.2 --library-path /usr/${TRIPLE}/lib)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
