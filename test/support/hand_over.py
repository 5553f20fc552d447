#!/usr/bin/env python3
"""Becomes the program in HAND_OVER_TO, with the descriptors in HAND_OVER_DESCRIPTORS as 3, 4, ...

LISTEN_PID says for whom they are, which only the process itself can know in time; so do
WATCHDOG_PID and others whose value is given as "self".
"""
import os
import sys

FIRST = 3

descriptors = [int(text) for text in os.environ["HAND_OVER_DESCRIPTORS"].split()]
own = str(os.getpid())
environment = {name: own if value == "self" else value for name, value in os.environ.items()}
environment.setdefault("LISTEN_PID", own)
environment.setdefault("LISTEN_FDS", str(len(descriptors)))

high = FIRST + 100
copies = [os.dup2(descriptor, high + i) for i, descriptor in enumerate(descriptors)]
for i, copy in enumerate(copies):
    os.dup2(copy, FIRST + i, inheritable=True)
os.closerange(FIRST + len(copies), high + len(copies))
os.execve(environment["HAND_OVER_TO"], [environment["HAND_OVER_TO"], *sys.argv[1:]], environment)
