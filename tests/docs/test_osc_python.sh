#!/usr/bin/env bash
# The Python program of docs/osc.md, as it stands there, beside `himc serve`: it hits, and prints the
# strike. Without python-osc it is ignored.
cd "$(dirname "$0")/../.." || exit 1
build=${HIMC_BUILD:-build}
work=$(mktemp -d)
serve= python=
trap 'kill $serve $python 2>/dev/null; wait 2>/dev/null; rm -rf "$work"' EXIT
name=tests/docs/test_osc_python.sh:$LINENO:the_program_of_the_manual_hits_and_prints_the_strike
if ! python3 -c 'import pythonosc' 2>/dev/null; then
    echo "$name:IGNORE: no python-osc"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' docs/osc.md >"$work/example.py"
"$build/bin/himc" serve --port 0 >"$work/serve" 2>&1 &
serve=$!
until grep -q 'listening at' "$work/serve"; do sleep 0.05; kill -0 $serve || exit 1; done
sed -i "s/9000/$(sed -n 's/.* port //p' "$work/serve")/; s/9001, stream/server.server_address[1], stream/; s/9001/0/" "$work/example.py"
python3 -u "$work/example.py" >"$work/out" 2>&1 &
python=$!
for ((i = 0; i < 200; i++)); do
    grep -q ' right kettle [0-9.]* m/s' "$work/out" && break
    sleep 0.05
done
if grep -q ' right kettle [0-9.]* m/s' "$work/out"; then
    echo "$name:PASS"
    echo "1 Tests 0 Failures 0 Ignored"
else
    echo "$name:FAIL: $(tail -n 1 "$work/out")"
    echo "1 Tests 1 Failures 0 Ignored"
    exit 1
fi
