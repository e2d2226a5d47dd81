#!/bin/sh
# What `himc serve` sends as VMC, read by an independent decoder, PyPI's vmcp; ignored where there is none.
#   VMCP_PYTHON: a python3 that has it
: "${HIMC_BUILD:=build}" "${VMCP_PYTHON:=python3}"
if ! "$VMCP_PYTHON" -c 'import vmcp.events' 2>/dev/null; then
    echo "tests/test_osc_vmc.sh:0:test_vmcp_reads_all_bones:IGNORE: no python3 with vmcp"
    echo "-----------------------"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
port=$((20000 + $$ % 20000)) # ours, should two of these run at once
timeout 60 "$HIMC_BUILD/bin/himc" serve --port $port >/dev/null &
server=$!
"$VMCP_PYTHON" - $port <<'EOF'
import socket, struct, sys, time
from vmcp.events import BoneTransformEvent, RootTransformEvent, StateEvent

def pad(text):
    text = text.encode() + b"\0"
    return text + b"\0" * (-len(text) % 4)

def word(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 4 - end % 4

def messages(data):
    if not data.startswith(b"#bundle"):
        path, at = word(data, 0)
        types, at = word(data, at)
        atoms = []
        for kind in types[1:]:
            if kind == "s":
                value, at = word(data, at)
            else:
                value, = struct.unpack_from(">" + kind, data, at)
                at += 4
            atoms.append(value)
        yield path, tuple(atoms)
        return
    at = 16
    while at < len(data):
        size, = struct.unpack_from(">i", data, at)
        yield from messages(data[at + 4:at + 4 + size])
        at += 4 + size

ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
ear.bind(("127.0.0.1", 0))
ear.settimeout(0.2)
ask = pad("/himc/subscribe") + pad(",sis") + pad("127.0.0.1") + struct.pack(">i", ear.getsockname()[1]) + pad("vmc")
bones, faults, state, root = {}, [], 0, 0
end = time.time() + 5
while time.time() < end and len(bones) < 21:
    ear.sendto(ask, ("127.0.0.1", int(sys.argv[1])))
    try:
        packet = ear.recv(65536)
    except (socket.timeout, ConnectionError):
        continue
    for path, atoms in messages(packet):
        try:
            if path == "/VMC/Ext/Bone/Pos":
                event = BoneTransformEvent.from_message_data("c", path, atoms)
                bones[event.joint] = event
            elif path == "/VMC/Ext/OK":
                state += StateEvent.from_message_data("c", path, atoms) is not None
            elif path == "/VMC/Ext/Root/Pos":
                root += RootTransformEvent.from_message_data("c", path, atoms) is not None
        except Exception as fault:
            faults.append(f"{path} {atoms}: {fault!r}")

def tell(name, good, why=""):
    print(f"tests/test_osc_vmc.sh:0:{name}:" + ("PASS" if good else f"FAIL: {why}"))
    return not good

failures = tell("test_vmcp_reads_all_bones", len(bones) == 21 and not faults, f"{len(bones)} bones {faults[:2]}")
failures += tell("test_vmcp_reads_state_and_root", state and root, f"{state} {root}")
print(f"-----------------------\n2 Tests {failures} Failures 0 Ignored")
EOF
kill $server
wait $server
