# 64 bits, most significant byte first.  Debian: gcc-s390x-linux-gnu, qemu-user.
set(CMAKE_SYSTEM_PROCESSOR s390x)
set(TRIPLE s390x-linux-gnu)
set(RUNNER qemu-s390x -L /usr/${TRIPLE})
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
