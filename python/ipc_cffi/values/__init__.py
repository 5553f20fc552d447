"""Values: from Python to the bytes of a format and back.

A format's tree is compiled into codecs, one for each node:

    misfit       what is said of a value that does not fit, and where it is
    scalars      numbers, characters, enumerations, strings
    blocks       numbers that lie in memory: buffers, NumPy
    arrays       fixed and variable arrays; whole rows of numbers at once
    structures   structures, pointers, linked lists
    compiler     makes the codecs of a tree; Converter is what the rest of the package uses
"""
from .codec import Content
from .compiler import Converter, Encoded
from .misfit import BadBytes

__all__ = ["BadBytes", "Content", "Converter", "Encoded"]
