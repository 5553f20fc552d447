"""Frames: the seven numbers in front of every message, and a cutter of byte streams."""
import dataclasses
import struct

HEADER = struct.Struct(">7i")

HANDLER_ONLY, QUERY, INFORM, REPLY, SUCCESS, FAILURE, BROADCAST = 1, 3, 6, 11, 12, 13, 15
NONE = -1
IS_REPLY = -4

ORDER_CODES = {">": 1, "<": 2}
ORDERS = {1: ">", 2: "<"}


@dataclasses.dataclass
class Frame:
    """One frame.  The order fields may hold a nibble (a number) instead of "<" or ">"."""

    cls: int
    intent: int = NONE
    data: bytes = b""
    class_data: bytes = b""
    parent: int = NONE
    dispatch: int = NONE
    reference: int = NONE
    order: str = "<"
    class_order: str = None
    alignment: int = 0
    class_length: int = None
    data_length: int = None

    def class_word(self):
        data_order = ORDER_CODES.get(self.order, self.order)
        class_order = self.order if self.class_order is None else self.class_order
        class_order = ORDER_CODES.get(class_order, class_order)
        word = class_order << 28 | data_order << 24 | self.alignment << 16 | self.cls & 0xffff
        return word - (1 << 32) if word >= 1 << 31 else word

    def header(self):
        """The header; class_length and data_length can be made to lie."""
        class_length = len(self.class_data) if self.class_length is None else self.class_length
        data_length = len(self.data) if self.data_length is None else self.data_length
        return HEADER.pack(class_length, data_length, self.parent, self.intent,
                           self.class_word(), self.dispatch, self.reference)

    def pack(self):
        return self.header() + self.class_data + self.data

    def message_name(self):
        """The message name in the class data, None when there is none."""
        if not self.class_data:
            return None
        order = ORDERS[ORDER_CODES.get(self.class_order, self.class_order)]
        length = struct.unpack_from(order + "i", self.class_data)[0]
        if length != len(self.class_data) - 4:
            raise ValueError(f"class data {self.class_data!r} is not one string")
        return self.class_data[4:].decode("latin-1")


def class_name(name, order="<"):
    """Class data that holds a message name."""
    raw = name.encode("latin-1")
    return struct.pack(order + "i", len(raw)) + raw


class Cutter:
    """Cuts a stream of bytes into frames."""

    def __init__(self):
        self.buffer = bytearray()

    def feed(self, data):
        self.buffer += data

    def take(self, length):
        """The next length bytes as they are, None while there are fewer."""
        if len(self.buffer) < length:
            return None
        raw = bytes(self.buffer[:length])
        del self.buffer[:length]
        return raw

    def next(self):
        """The next frame, None while it is incomplete."""
        if len(self.buffer) < HEADER.size:
            return None
        class_length, data_length, parent, intent, word, dispatch, reference = (
            HEADER.unpack_from(self.buffer))
        if class_length < 0 or data_length < 0:
            raise ValueError(f"frame with lengths {class_length} and {data_length}")
        if len(self.buffer) < HEADER.size + class_length + data_length:
            return None
        body = self.take(HEADER.size + class_length + data_length)[HEADER.size:]
        return Frame(cls=word & 0xffff, intent=intent, data=body[class_length:],
                     class_data=body[:class_length], parent=parent, dispatch=dispatch,
                     reference=reference, order=ORDERS.get(word >> 24 & 15, word >> 24 & 15),
                     class_order=ORDERS.get(word >> 28 & 15, word >> 28 & 15),
                     alignment=word >> 16 & 255)
