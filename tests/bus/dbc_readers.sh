#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Readers that are not ours read rt/wire/fray.dbc: cantools if it is there, else canmatrix (Debian:
# python3-canmatrix). They decode a plain, a protected and a TAG frame; expected values by hand. And
# the lines keep to what SavvyCAN's reader takes: one line each, no exponents, one blank before `(`.
. tests/lib/suite.sh

dbc=rt/wire/fray.dbc
number='[0-9.-]+'
bad=$(grep -E '^ *SG_' $dbc |
  grep -vE "^ SG_ [A-Za-z0-9_]{1,32} : [0-9]+\|[0-9]+@1[+-] \($number,$number\) \[$number\|$number\] \"[^\"]*\" [A-Za-z,]+\$" || true)
if [ -z "$bad" ]; then pass; else fail "signals that SavvyCAN does not take: $bad"; fi
bad=$(grep -E '^(CM_|VAL_|BA_)' $dbc | grep -v ';$' || true)
if [ -z "$bad" ]; then pass; else fail "not on one line: $bad"; fi
if LC_ALL=C grep -nq '[^ -~]' $dbc; then fail "not ASCII"; else pass; fi

reader=$(cat <<'PYTHON'
import sys, warnings
warnings.simplefilter("ignore")
EXPECTED = [
    (0x101, "28A3010002FF0080", {"Counter": 3, "Buttons": 10, "X": 2, "Y": -508, "Z": -65536}),
    (0x109, "28A3010002FF008078563412CFD4B5BF447B45B3",
     {"Counter": 3, "X": 2, "Z": -65536, "Freshness": 0x12345678, "Tag0": 0xBFB5D4CF, "Tag1": 0xB3457B44}),
    (0x709, "EFBEADDE01000080", {"Physics": 0xDEADBEEF, "TickHigh": 0x80000001}),
    (0x020, "EC01010000000000010000001A7E6F6E190A0D72", {"Command": "START", "Freshness": 1}),
    (0x301, "01009F0C5A934395", {"Freshness": 1, "Tag": 0x9543935A0C9F}),
    (0x181, "0025FFFF02000180", {"Counter": 5, "Consumed": 2, "X": -0.5, "Y": 1, "Z": -16383.5}),
    (0x701, "0332210000000100", {"State": "SAFE", "PoolFill": 50, "StaleLeft": "STALE_LEFT",
                                 "Halted": "HALTED", "BreakBudget": "OK", "Tears": 1}),
    (0x701, "0300080F00000000", {"StaleLeft": "OK", "BreakBudget": "BREAK_BUDGET", "ParticlesFull": "OK",
                                 "SelfCollisionBudget": "SELF_COLLISION_BUDGET", "ContactUnresolved": "CONTACT_UNRESOLVED",
                                 "MeshQueryBudget": "MESH_QUERY_BUDGET", "TrianglesFull": "TRIANGLES_FULL"}),
    (0x701, "0300003000000000", {"TrianglesFull": "OK", "Overstretched": "OVERSTRETCHED", "SpeedLimit": "SPEED_LIMIT"}),
    (0x701, "0300C00000000000", {"Halted": "OK", "ParticlesFull": "PARTICLES_FULL", "SplitBudget": "SPLIT_BUDGET",
                                 "SelfCollisionBudget": "OK"}),
]
CYCLES = {0x080: 1, 0x101: 1, 0x109: 1, 0x189: 1, 0x301: 4, 0x701: 100, 0x010: 0}
try:
    import cantools
    name = "cantools"
    base = cantools.database.load_file(sys.argv[1])
    messages = {m.frame_id: (m.name, m.length, bool(m.is_fd), m.cycle_time or 0, m.comment) for m in base.messages}
    fd_bus = base.dbc.attributes["BusType"].value == "CAN FD"
    def decode(id, data):
        return {k: str(v) if hasattr(v, "name") else v for k, v in base.decode_message(id, data).items()}
except ImportError:
    import canmatrix.formats
    name = "canmatrix"
    base = list(canmatrix.formats.loadp(sys.argv[1]).values())[0]
    frames = {f.arbitration_id.id: f for f in base.frames}
    messages = {i: (f.name, f.size, bool(f.is_fd), int(f.cycle_time), f.comment) for i, f in frames.items()}
    fd_bus = True
    def decode(id, data):
        out = {}
        for k, v in frames[id].decode(data).items():
            out[k] = v.named_value if v.signal.values else float(v.phys_value)
        return out
bad = [] if fd_bus else ["BusType is not CAN FD"]
if len(messages) != 18: bad.append("%d messages" % len(messages))
for id, (message, length, fd, cycle, comment) in messages.items():
    if fd != message.endswith("_AUTH") or length != (20 if fd else 8): bad.append("%s: FD %s, %d bytes" % (message, fd, length))
    if not comment: bad.append(message + " has no comment")
    if cycle != CYCLES.get(id, cycle): bad.append("%s every %d ms" % (message, cycle))
for id, data, values in EXPECTED:
    got = decode(id, bytes.fromhex(data))
    for signal, value in values.items():
        is_value = got[messages[id][0] + "_" + signal]
        if is_value != value: bad.append("%s %s: %s, expected %s" % (messages[id][0], signal, is_value, value))
print("  read by " + name)
print("\n".join("bad: " + b for b in bad))
sys.exit(3 if bad else 0)
PYTHON
)
mkdir -p "$FRAY_BUILD/bus"
printf '%s\n' "$reader" >"$FRAY_BUILD/bus/dbc_reader.py"
python=''
for candidate in python3 /usr/bin/python3; do
  for module in cantools canmatrix; do
    [ -n "$python" ] || ! "$candidate" -c "import $module" >/dev/null 2>&1 || python=$candidate
  done
done
if [ -z "$python" ]; then
  not_run "fray.dbc in another reader" python3-canmatrix
elif "$python" "$FRAY_BUILD/bus/dbc_reader.py" $dbc >"$FRAY_BUILD/bus/dbc_reader.txt" 2>"$FRAY_BUILD/bus/dbc_reader.err"; then
  grep '^  read by' "$FRAY_BUILD/bus/dbc_reader.txt"
  pass
else
  fail "fray.dbc: $(grep '^bad' "$FRAY_BUILD/bus/dbc_reader.txt" || tail -n 5 "$FRAY_BUILD/bus/dbc_reader.err")"
fi
suite_end
