"""What the peers by Google's protobuf share: messages from a table of their fields."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer, skip, version  # noqa: E402

try:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
except ImportError:
    skip("python3-protobuf")

UINT, ENUM, DOUBLE = 13, 5, 1  # an enumeration is a number on the wire
ONE, MANY = 1, 3
_PART = 11


def classes(package, messages, names):
    """Of `messages`, {name: [(field, number, type or the name of a message, ONE or MANY)]}, those in `names`."""
    file = descriptor_pb2.FileDescriptorProto(name=package + ".proto", package=package, syntax="proto2")
    for name, fields in messages.items():
        message = file.message_type.add(name=name)
        for field, number, kind, label in fields:
            f = message.field.add(name=field, number=number, label=label)
            f.type = _PART if isinstance(kind, str) else kind
            if isinstance(kind, str):
                f.type_name = "." + package + "." + kind
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    get = message_factory.MessageFactory(pool).GetPrototype
    return [get(pool.FindMessageTypeByName(package + "." + name)) for name in names]



peer = Peer("protobuf %s, %s" % (version("protobuf"), "controller" if "--controller" in sys.argv else "job"))
check = peer.require
