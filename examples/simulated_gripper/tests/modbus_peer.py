#!/usr/bin/env python3
"""pymodbus at both ends of an OnRobot gripper.

modbus_peer.py PATH/simulated_gripper   a client, as public clients of RG grippers call it
modbus_peer.py PATH/move_gripper        a server that plays the gripper
"""
import asyncio
import logging
import os
import re
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from peer import Peer, skip, version  # noqa: E402

try:
    from pymodbus.client import ModbusTcpClient
    from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
    from pymodbus.server import StartAsyncTcpServer
except ImportError:
    skip("python3-pymodbus python3-serial-asyncio")

logging.disable()  # of connections that end
UNIT, FORCE, WIDTH, CONTROL, TIP, NOW, STATUS, TIPS = 65, 0, 1, 2, 258, 267, 268, 275
GRIP, HALT, GRIP_TIPS, BUSY, HOLDS = 1, 8, 16, 1, 2


def be_client(program):
    peer = Peer("pymodbus %s, client" % version("pymodbus"))
    gripper = subprocess.Popen([program, "onrobot", "--object", "0.03", "--speed", "4"], stdout=subprocess.PIPE, text=True)
    try:
        port = int(re.search(r"port=(\d+)", gripper.stdout.readline()).group(1))
        client = ModbusTcpClient("127.0.0.1", port=port)
        peer.check(client.connect(), "a connection")

        def read(address, count=1):
            answer = client.read_holding_registers(address, count, slave=UNIT)
            return None if answer.isError() else answer.registers

        def rest():
            until = time.monotonic() + 5
            while read(STATUS)[0] & BUSY and time.monotonic() < until:
                time.sleep(0.01)
            return read(STATUS)[0]

        peer.equal(read(NOW, 2), [1100, 0], "open, at rest")
        peer.equal(read(TIP), [0], "fingertips")
        answer = client.write_registers(FORCE, [200, 0, GRIP], slave=UNIT)
        peer.equal((answer.isError(), answer.address, answer.count), (False, FORCE, 3), "a grip, function 16")
        peer.equal(read(STATUS)[0] & BUSY, BUSY, "it moves")
        peer.equal(rest(), HOLDS, "it holds what is between its fingers")
        peer.equal(read(NOW), [300], "as wide as that")
        for address, value in ((FORCE, 100), (WIDTH, 900), (CONTROL, GRIP)):
            answer = client.write_register(address, value, slave=UNIT)
            peer.equal((answer.isError(), getattr(answer, "value", None)), (False, value), "register %d, function 6" % address)
        peer.equal(rest(), 0, "it opens, and holds nothing")
        peer.equal(read(NOW), [900], "to the width")
        client.write_registers(FORCE, [100, 0, GRIP], slave=UNIT)
        client.write_register(CONTROL, HALT, slave=UNIT)
        peer.equal(rest(), 0, "it stops")
        peer.check(300 < read(NOW)[0] <= 900, "on its way: %r" % read(NOW))
        peer.check(client.read_holding_registers(300, 1, slave=UNIT).isError(), "a register that is none, read")
        peer.check(client.write_register(300, 1, slave=UNIT).isError(), "a register that is none, written")
        peer.equal(client.read_holding_registers(300, 1, slave=UNIT).exception_code, 2, "illegal data address")
        peer.check(client.read_coils(0, 1, slave=UNIT).isError(), "a function that it has not")
        peer.equal(read(TIPS), read(NOW), "between the fingertips, without an offset")
        client.close()
    finally:
        gripper.terminate()
        gripper.wait()
    peer.end()


class Gripper(ModbusSequentialDataBlock):
    """Registers of an RG2 that closes on something 30 mm wide, 0.3 s after it was told to."""

    def __init__(self):
        super().__init__(0, [0] * 512)
        super().setValues(NOW, [1100])
        self.told, self.until, self.goal = [], 0, 1100

    def setValues(self, address, values):
        super().setValues(address, values)
        self.told.append((address, list(values)))
        if super().getValues(CONTROL, 1) == [GRIP]:
            self.goal, self.until = super().getValues(WIDTH, 1)[0], time.monotonic() + 0.3
            super().setValues(CONTROL, [0])

    def getValues(self, address, count=1):
        if time.monotonic() >= self.until:
            super().setValues(NOW, [max(self.goal, 300)])
        super().setValues(STATUS, [BUSY if time.monotonic() < self.until else HOLDS if self.goal < 300 else 0])
        return super().getValues(address, count)


def be_server(program):
    peer = Peer("pymodbus %s, server" % version("pymodbus"))
    gripper = Gripper()

    async def move(port, *more):
        job = await asyncio.create_subprocess_exec(program, "onrobot", "--host", "127.0.0.1", "--port", str(port), "-q", *more,
                                                   stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT)
        said, _ = await asyncio.wait_for(job.communicate(), 20)
        return job.returncode, said.decode()

    async def serve():
        context = ModbusServerContext(slaves={UNIT: ModbusSlaveContext(hr=gripper, zero_mode=True)}, single=False)
        server = await StartAsyncTcpServer(context, address=("127.0.0.1", 0), defer_start=True)
        task = asyncio.ensure_future(server.serve_forever())
        while server.server is None or not server.server.sockets:
            await asyncio.sleep(0.01)
        port = server.server.sockets[0].getsockname()[1]
        code, said = await move(port)
        peer.check(code == 0 and "110.0 mm open" in said and "holds" not in said, "where it stands: %d %s" % (code, said))
        peer.equal(gripper.told, [], "nothing was told")
        code, said = await move(port, "--close", "--force", "20")
        peer.check(code == 0 and "30.0 mm open, holds an object with 20.0 N" in said, "it closes: %d %s" % (code, said))
        peer.equal(gripper.told, [(FORCE, [200, 0, GRIP])], "20 N, 0 mm, grip")
        del gripper.told[:]
        code, said = await move(port, "--opening", "0.08", "--force", "5")
        peer.check(code == 0 and "80.0 mm open\n" in said, "it opens: %d %s" % (code, said))
        peer.equal(gripper.told, [(FORCE, [50, 800, GRIP])], "5 N, 80 mm, grip")
        task.cancel()

    asyncio.run(serve())
    peer.end()


(be_server if "move_gripper" in os.path.basename(sys.argv[1]) else be_client)(sys.argv[1])
