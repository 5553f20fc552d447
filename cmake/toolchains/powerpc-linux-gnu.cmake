# 32 bits, most significant byte first.  Debian: gcc-powerpc-linux-gnu, qemu-user.
set(CMAKE_SYSTEM_PROCESSOR ppc)
set(TRIPLE powerpc-linux-gnu)
set(RUNNER qemu-ppc -L /usr/${TRIPLE})
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
