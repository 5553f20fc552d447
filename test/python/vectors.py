"""Formats and values of test/vectors as values of Python, by the trees of their formats."""
import json
import os
import struct

from python.tools import ROOT, ipc

tree = ipc.formatters.tree


def load(name):
    """A file of vectors."""
    with open(os.path.join(ROOT, "test", "vectors", f"{name}.json"), encoding="utf-8") as file:
        return json.load(file)


def _real(value, code):
    if not isinstance(value, dict):
        return struct.unpack(code, struct.pack(code, value))[0]
    return struct.unpack(f">{code}", bytes.fromhex(value["bits"]))[0]


def _primitive(name, value, sending):
    if name in ("float", "double"):
        return _real(value, name[0])
    if name == "string":
        raw = (value or "").encode("latin-1")
        return (raw if value is not None else None) if sending else raw.decode(
            "utf-8", "surrogateescape")
    if name == "char":
        return chr(value)
    if name == "boolean":
        return bool(value)
    return int(value)


def shaped(values, dimensions):
    """A flat list as a nested one."""
    if len(dimensions) == 1 or not values:
        return list(values)
    size = len(values) // dimensions[0]
    return [shaped(values[k * size:(k + 1) * size], dimensions[1:]) for k in range(dimensions[0])]


def python_value(node, value, sending, enclosing=None):
    """A value of a vector file, for encoding, or as it is decoded; structures are lists."""
    def member_value(member):
        return python_value(member[0], member[1], sending, node)
    if isinstance(node, tree.Primitive):
        return _primitive(node.name, value, sending)
    if isinstance(node, tree.Raw):
        return bytes.fromhex(value)
    if isinstance(node, tree.Enumeration):
        return value
    if isinstance(node, tree.Structure):
        members = [member_value(member) if not isinstance(member[0], tree.VariableArray) else None
                   for member in zip(node.members, value)]
        for index, member in enumerate(node.members):
            if isinstance(member, tree.VariableArray):
                elements = [python_value(member.element, element, sending)
                            for element in value[index] or ()]
                sizes = [members[reference] for reference in member.references]
                members[index] = shaped(elements, sizes)
        return members
    if isinstance(node, (tree.Pointer, tree.SelfPointer)):
        target = enclosing if isinstance(node, tree.SelfPointer) else node.target
        return None if value is None else python_value(target, value["ptr"], sending)
    return _nested(node, value, len(node.dimensions), sending)


def _nested(node, value, depth, sending):
    if depth == 0:
        return python_value(node.element, value, sending)
    return [_nested(node, part, depth - 1, sending) for part in value]


def generated(name):
    """The value of a generator of cases.json."""
    def numbers():
        state = 1
        while True:
            state = (state * 1103515245 + 12345) & 0x7fffffff
            yield state >> 8
    number = numbers()
    take = lambda count: (next(number) for _ in range(count))
    if name == "LCG_i8":
        return [1000000, [(r & 255) - 128 for r in take(1000000)]]
    if name == "LCG_f64":
        return [100000, [r / 1024.0 for r in take(100000)]]
    if name == "LCG_cis":
        return [20000, [[chr(r & 127), r, (r >> 3) & 32767] for r in take(20000)]]
    if name == "LCG_str":
        return [5000, ["" if r % 10 == 0 else "".join(chr(97 + (r + k) % 26)
                                                      for k in range(r % 37 + 1))
                       for r in take(5000)]]
    if name == "LCG_u8_2d":
        row = [r & 255 for r in take(480 * 640)]
        return shaped(row, (480, 640))
    nodes = None
    for r in reversed(list(take(10000))):
        nodes = [r, nodes]
    return nodes
