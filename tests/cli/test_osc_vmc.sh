#!/bin/sh
# What `himc serve` sends as VMC, read by an independent decoder, PyPI's vmcp; ignored where there is none.
#   VMCP_PYTHON: a python3 that has it
: "${HIMC_BUILD:=build}" "${VMCP_PYTHON:=python3}"
if ! "$VMCP_PYTHON" -c 'import vmcp.events' 2>/dev/null; then
    echo "tests/cli/test_osc_vmc.sh:0:test_vmcp_reads_all_bones:IGNORE: no python3 with vmcp"
    echo "-----------------------"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
port=$((20000 + 8 * $$ % 12000)) # and 7 after it; ours, should two of these run at once, and below those that the system gives
timeout 300 "$HIMC_BUILD/bin/himc" serve --port $port >/dev/null &
server=$!
"$VMCP_PYTHON" - $port <<'EOF'
import socket, struct, sys, time
from vmcp.events import BoneTransformEvent, DeviceTransformEvent, RelativeTimeEvent, RootTransformEvent, StateEvent

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
hit = pad("/himc/hit") + pad(",sss") + pad("left") + pad("accent") + pad("ff")
bones, places, mallets, notes, times, faults, state, root = {}, {}, {}, [], [], [], 0, 0
end, hit_again = time.time() + 60, 0  # for all to come; it takes a second
while time.time() < end and (len(bones) < 21 or len(mallets) < 2 or len(notes) < 2):
    try:
        ear.sendto(ask, ("127.0.0.1", int(sys.argv[1])))
        if bones and time.time() > hit_again:  # heard, so the note is heard too
            ear.sendto(hit, ("127.0.0.1", int(sys.argv[1])))
            hit_again = time.time() + 5
        packet = ear.recv(65536)
    except (socket.timeout, ConnectionError):
        continue
    for path, atoms in messages(packet):
        try:
            if path == "/VMC/Ext/Bone/Pos":
                event = BoneTransformEvent.from_message_data("c", path, atoms)
                bones[event.joint] = event
                places[atoms[0]] = atoms[1:4]
            elif path == "/VMC/Ext/Tra/Pos":
                mallets[atoms[0]] = DeviceTransformEvent.from_message_data("c", path, atoms)
                places[atoms[0]] = atoms[1:4]
            elif path == "/VMC/Ext/T":
                times.append(RelativeTimeEvent.from_message_data("c", path, atoms).delta)
            elif path == "/VMC/Ext/Midi/Note":
                notes.append(atoms)
            elif path == "/VMC/Ext/OK":
                state += StateEvent.from_message_data("c", path, atoms) is not None
            elif path == "/VMC/Ext/Root/Pos":
                root += RootTransformEvent.from_message_data("c", path, atoms) is not None
        except Exception as fault:
            faults.append(f"{path} {atoms}: {fault!r}")

def tell(name, good, why=""):
    print(f"tests/cli/test_osc_vmc.sh:0:{name}:" + ("PASS" if good else f"FAIL: {why}"))
    return not good

failures = tell("test_vmcp_reads_all_bones", len(bones) == 21 and not faults, f"{len(bones)} bones {faults[:2]}")
failures += tell("test_vmcp_reads_state_and_root", state and root, f"{state} {root}")
failures += tell("test_vmcp_reads_mallets_as_trackers", sorted(mallets) == ["left-mallet", "right-mallet"], f"{list(mallets)}")
failures += tell("test_vmcp_reads_times_that_go_on", len(times) > 2 and times == sorted(times), f"{times[:4]}")
# left-handed, y up: x to the performer's right, z forward
at = lambda name, i: places.get(name, (9, 9, 9))[i]
failures += tell("test_left_is_at_negative_x_and_up_is_y",
                 at("LeftUpperLeg", 0) < 0 < at("RightUpperLeg", 0) and 0.3 < at("Hips", 1) < 1.2 and at("left-mallet", 2) > 0.2,
                 f"{places}")
failures += tell("test_a_strike_is_a_note_on_and_off", len(notes) >= 2 and notes[0][:2] == (1, 0) and 0 < notes[0][3] <= 1
                 and notes[1] == (0, 0, notes[0][2], 0.0), f"{notes}")
print(f"-----------------------\n6 Tests {failures} Failures 0 Ignored")
EOF
kill $server
wait $server
