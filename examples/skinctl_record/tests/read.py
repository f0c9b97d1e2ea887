"""Reads an MCAP file by its index and decodes every message by its schema, with the standard library alone.

Written from the specifications (mcap.dev, OMG CDR, REP 2016), not from skinctl. Prints a line of JSON for each message,
and one for each type: {"type", "hash"}. Any disagreement of lengths, CRCs, indexes or hashes ends it with exit code 1.
"""
import hashlib
import json
import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"
KINDS = {"int8": ("b", 2), "uint8": ("B", 3), "int16": ("h", 4), "uint16": ("H", 5), "int32": ("i", 6), "uint32": ("I", 7),
         "int64": ("q", 8), "uint64": ("Q", 9), "float32": ("f", 10), "float64": ("d", 11), "bool": ("?", 15), "string": (None, 17)}


def require(condition, what):
    if not condition:
        sys.exit("read.py: " + what)


class Bytes:
    def __init__(self, data, at=0):
        self.data, self.at = data, at

    def get(self, form):
        size = struct.calcsize("<" + form)
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += size
        return values if len(values) > 1 else values[0]

    def take(self, n):
        require(n <= len(self.data) - self.at, "a length beyond the end")
        self.at += n
        return self.data[self.at - n:self.at]

    def text(self):
        return self.take(self.get("I")).decode()

    def pairs(self, one):
        inner = Bytes(self.take(self.get("I")))
        out = []
        while inner.at < len(inner.data):
            out.append(one(inner))
        return out


def record(data, at):
    op, length = struct.unpack_from("<BQ", data, at)
    require(at + 9 + length <= len(data), "a record beyond the end")
    return op, Bytes(data[at + 9:at + 9 + length]), at + 9 + length


def full(name, owner):
    parts = name.split("/")
    return owner.rsplit("/", 1)[0] + "/" + name if len(parts) == 1 else name if len(parts) == 3 else parts[0] + "/msg/" + parts[1]


def definitions(name, schema):
    """{type: [(field, type, is sequence)]}"""
    types = {}
    for k, block in enumerate(schema.split("=" * 80 + "\n")):
        lines = block.splitlines()
        owner = name if k == 0 else full(lines.pop(0)[len("MSG: "):], name)
        types[owner] = []
        for line in lines:
            kind, rest = line.split(None, 1)
            if "=" in rest:
                continue
            sequence = kind.endswith("[]")
            kind = kind[:-2] if sequence else kind
            types[owner].append((rest.split()[0], kind if kind in KINDS else full(kind, owner), sequence))
    return types


def type_hash(name, types):
    def one(owner):
        fields = []
        for field, kind, sequence in types[owner]:
            nested = kind not in KINDS
            number = (1 if nested else KINDS[kind][1]) + (144 if sequence else 0)
            fields.append({"name": field, "type": {"type_id": number, "capacity": 0, "string_capacity": 0,
                                                   "nested_type_name": kind if nested else ""}})
        return {"type_name": owner, "fields": fields}

    used, todo = set(), [name]
    while todo:
        for _, kind, _ in types[todo.pop()]:
            if kind not in KINDS and kind not in used:
                used.add(kind)
                todo.append(kind)
    text = json.dumps({"type_description": one(name), "referenced_type_descriptions": [one(t) for t in sorted(used)]})
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


class Message(Bytes):
    """CDR: members aligned to their size behind the four bytes of the header."""

    def number(self, form):
        size = struct.calcsize("<" + form)
        self.at += -(self.at - 4) % size
        return self.get(form)

    def value(self, kind, types):
        if kind == "string":
            data = self.take(self.number("I"))
            require(data[-1:] == b"\0", "a string without its end")
            return data[:-1].decode()
        if kind in KINDS:
            return self.number(KINDS[kind][0])
        return {field: self.member(inner, sequence, types) for field, inner, sequence in types[kind]}

    def member(self, kind, sequence, types):
        if not sequence:
            return self.value(kind, types)
        n = self.number("I")
        return list(self.take(n)) if kind == "uint8" else [self.value(kind, types) for _ in range(n)]


def main(path):
    data = open(path, "rb").read()
    require(data[:8] == MAGIC and data[-8:] == MAGIC, "no magic")
    op, footer, end = record(data, len(data) - 8 - 29)
    require(op == 2 and end == len(data) - 8, "no footer")
    summary, offsets, crc = footer.get("QQI")
    require(zlib.crc32(data[summary:len(data) - 8 - 4]) == crc, "CRC of the summary")
    schemas, channels, chunks, at = {}, {}, [], summary
    while at < offsets:
        op, r, at = record(data, at)
        if op == 3:
            number = r.get("H")
            schemas[number] = (r.text(), r.text(), r.text())
        elif op == 4:
            number, schema = r.get("HH")
            channels[number] = (schema, r.text(), r.text(), dict(r.pairs(lambda b: (b.text(), b.text()))))
        elif op == 8:
            first, last, start, length = r.get("QQQQ")
            chunks.append((first, last, start, length, r.pairs(lambda b: b.get("HQ")), r.get("Q")))
        elif op == 11:
            statistics = r.get("QHIIII"), r.get("QQ"), dict(r.pairs(lambda b: b.get("HQ")))
    types = {n: definitions(name, text) for n, (name, _, text) in schemas.items()}
    for n, (name, encoding, _) in sorted(schemas.items()):
        require(encoding == "ros2msg", "an unknown encoding of schemas")
        print(json.dumps({"type": name, "hash": type_hash(name, types[n])}))
    counts, lines = {}, []
    for first, last, start, length, indexes, index_length in chunks:
        op, r, end = record(data, start)
        require(op == 6 and end == start + length, "a chunk is not where its index says")
        require(r.get("QQ") == (first, last), "times of a chunk")
        size, crc = r.get("QI")
        require(r.text() == "", "a compressed chunk")
        inner = r.take(r.get("Q"))
        require(len(inner) == size and zlib.crc32(inner) == crc, "CRC of a chunk")
        for channel, place in indexes:
            op, r, _ = record(data, place)
            require(op == 7 and r.get("H") == channel, "an index is not where its chunk says")
            for time, offset in r.pairs(lambda b: b.get("QQ")):
                op, m, _ = record(inner, offset)
                number, sequence, log_time, _ = m.get("HIQQ")
                require(op == 5 and number == channel and log_time == time and first <= time <= last, "a message is not where its index says")
                counts[channel] = counts.get(channel, 0) + 1
                schema, topic, encoding, metadata = channels[channel]
                out = {"topic": topic, "time": time, "sequence": sequence}
                if encoding == "cdr":
                    name = schemas[schema][0]
                    require(metadata["topic_type_hash"] == type_hash(name, types[schema]), "hash of " + name)
                    message = Message(m.data[m.at:])
                    require(message.take(4) == b"\0\1\0\0", "a header of CDR")
                    out["message"] = message.value(name, types[schema])
                    require(message.at == len(message.data), "bytes behind a message")
                else:
                    out["hex"] = m.data[m.at:].hex()
                lines.append(out)
    require(statistics[2] == counts and statistics[0][0] == sum(counts.values()), "statistics")
    require(statistics[0][1:] == (len(schemas), len(channels), 0, statistics[0][4], len(chunks)), "statistics of the summary")
    for line in sorted(lines, key=lambda l: (l["time"], l["topic"], l["sequence"])):
        print(json.dumps(line))


main(sys.argv[1])
