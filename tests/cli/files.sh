# SPDX-License-Identifier: Apache-2.0
# What a command does with its files, where things go wrong: a full disk, a closed pipe, a folder without rights, an
# output that is an input, an input without an end, a signal. The old file stays, and nothing else is left.
# Part of cli.sh, which sources it.

dir=$cd_work/files
mkdir -p "$dir/out"

is() { # WHAT FOUND EXPECTED
  if [ "$2" = "$3" ]; then pass; else fail "$1: '$2', expected '$3'"; fi
}

# ---- standard output
if [ -w /dev/full ]; then
  for use in "info $image" "run $image --ticks 3" "--help" "--version" "bench $image --ticks 2" "render $image --at 1ms --size 64x64 -o $dir/r"; do
    # shellcheck disable=SC2086
    code=0 && "$FRAY" $use >/dev/full 2>"$cd_work/said" || code=$?
    is "fray $use into a full disk: exit" "$code" 1
    is "fray $use into a full disk" "$(tail -n 1 "$cd_work/said")" "fray: standard output cannot be written: No space left on device"
  done
fi
{ code=0 && "$FRAY" info "$image" 2>"$cd_work/said" || code=$?; echo $code >"$cd_work/code"; } | head -n 0
sleep 0.1
if [ "$(cat "$cd_work/code")" = 141 ] || [ "$(cat "$cd_work/code")" = 0 ]; then pass; else fail "into a closed pipe: exit $(cat "$cd_work/code")"; fi
is "into a closed pipe: says" "$(cat "$cd_work/said")" ""

# ---- files that cannot be written whole: an old one stays, byte for byte, and no other is left
# stays FILE CODE WORDS COMMAND...: with a disk that takes 2 KiB of a file
# shellcheck disable=SC2016
stays() { # without a word of SIGXFSZ, which ends a process by default
  file=$1 expected=$2 says=$3
  shift 3
  echo "old" >"$file"
  wants "$expected" "$says" sh -c 'ulimit -f 4 && exec "$@" >/dev/null' sh "$@"
  is "$file after a full disk" "$(cat "$file")" old
  is "what is left in $dir/out" "$(ls -A "$dir/out")" "$(basename "$file")"
  rm "$file"
}
stays "$dir/out/a.img" 1 "a.img: cannot be written: File too large" "$FRAY" scene "$small" -o "$dir/out/a.img"
stays "$dir/out/a.c" 1 "a.c: cannot be written: File too large" "$FRAY" scene "$small" --emit-c a -o "$dir/out/a.c"
stays "$dir/out/a.log" 1 "a.log: cannot be written: File too large" "$FRAY" run "$image" --ticks 300 --record "$dir/out/a.log"
stays "$dir/out/b.img" 1 "b.img: cannot be written: File too large" "$FRAY" run "$image" --ticks 3 --save "$dir/out/b.img"
stays "$dir/out/h.log" 1 "h.log: cannot be written: File too large" "$FRAY" hand -o "$dir/out/h.log" tests/determinism/small.hand
stays "$dir/out/frame_00000.png" 1 "frame_00000.png: cannot be written: File too large" "$FRAY" run "$image" --ticks 3 --report "$dir/out"
stays "$dir/out/b.json" 1 "b.json: cannot be written: File too large" "$FRAY" bench "$image" --ticks 3 --json "$dir/out/b.json"
stays "$dir/out/j.json" 2 "none.log: cannot be opened" "$FRAY" bench "$image" --ticks 3 --log "$dir/none.log" --json "$dir/out/j.json"

# ---- a folder without rights; the limits of a user
if [ "$(id -u)" != 0 ] || have setpriv; then
  as_user=
  if [ "$(id -u)" = 0 ]; then as_user="setpriv --reuid 65534 --regid 65534 --clear-groups"; fi
  locked=$(mktemp -d) && cp "$FRAY" "$image" "$locked" && echo old >"$locked/old.log" && chmod 755 "$locked" && chmod 644 "$locked"/*.* && chmod 755 "$locked/fray"
  if [ -z "$as_user" ]; then chmod 555 "$locked"; fi
  wants 1 "$locked/old.log: cannot be written: Permission denied" $as_user "$locked/fray" run "$locked/s.img" --ticks 3 --record "$locked/old.log"
  wants 1 "$locked/new.img: cannot be written: Permission denied" $as_user "$locked/fray" run "$locked/s.img" --ticks 3 --save "$locked/new.img"
  is "a file in a folder without rights" "$(cat "$locked/old.log")" old
  chmod 755 "$locked" && rm -r "$locked"
else
  not_run "a folder without rights" setpriv
fi

# ---- an output is no input, by whatever name
cp "$log" "$dir/in.log"
ln "$dir/in.log" "$dir/hard.log"
ln -s in.log "$dir/soft.log"
cp "$small" "$dir/in.scene"
before=$(cksum <"$dir/in.log")
for other in in.log hard.log soft.log ../files/in.log; do
  wants 2 "--record $dir/$other is the file of --log $dir/in.log" "$FRAY" run "$image" --log "$dir/in.log" --record "$dir/$other"
  wants 2 "is the file of --log" "$FRAY" run "$image" --log "$dir/$other" --save "$dir/in.log"
  wants 2 "is the file of --log" "$FRAY" bench "$image" --log "$dir/$other" --ticks 2 --json "$dir/in.log"
  is "$other" "$(cksum <"$dir/in.log")" "$before"
done
wants 2 "-o $dir/in.scene is the file of the input $dir/in.scene" "$FRAY" scene "$dir/in.scene" -o "$dir/in.scene"
wants 2 "--save $dir/in.scene is the file of the input" "$FRAY" run "$dir/in.scene" --ticks 2 --save "$dir/in.scene"
wants 2 "is the file of --record" "$FRAY" run "$image" --ticks 2 --save "$dir/new" --record "$dir/new"
is "the scene" "$(cksum <"$dir/in.scene")" "$(cksum <"$small")"
cp tests/determinism/small.hand "$dir/in.hand"
wants 2 "-o $dir/in.hand is the file of the input" "$FRAY" hand -o "$dir/in.hand" "$dir/in.hand"
is "the script" "$(cksum <"$dir/in.hand")" "$(cksum <tests/determinism/small.hand)"
cp "$small" "$dir/named.img" # a scene of this name, whose image has the same one
wants 2 "-o $dir/named.img is the file of the input $dir/named.img" "$FRAY" scene "$dir/named.img"
is "a scene named as an image" "$(cksum <"$dir/named.img")" "$(cksum <"$small")"
cp "$small" "$dir/linked.scene" && ln -s linked.scene "$dir/linked.img"
wants 2 "-o $dir/linked.img is the file of the input $dir/linked.scene" "$FRAY" scene "$dir/linked.scene"
is "a scene whose image is a link to it" "$(cksum <"$dir/linked.scene")" "$(cksum <"$small")"
# two outputs that are one file, before it is there
mkdir "$dir/d" && ln -s d "$dir/dl"
for other in ./d/x d/../d/x dl/x d/./x d//x; do
  wants 2 "--save $dir/$other is the file of --record $dir/d/x" "$FRAY" run "$image" --ticks 2 --record "$dir/d/x" --save "$dir/$other"
done
wants 2 "--save new.img is the file of --record ./new.img" "$FRAY" run "$image" --ticks 2 --record ./new.img --save new.img
for other in summary.txt frame_00000.png work.png; do
  for folder in "$dir/d" "$dir/dl/" "$dir/none/rep" "$dir/none/./rep/"; do
    wants 2 "--report $folder goes over the file of --record" "$FRAY" run "$image" --ticks 2 --report "$folder" --record "${folder%/}/$other"
  done
done
wants 2 "--report $dir/d goes over the file of --record $dir/d" "$FRAY" run "$image" --ticks 2 --report "$dir/d" --record "$dir/d"
is "what was made" "$(ls -A "$dir/d")$(ls -d "$dir/none" new.img 2>/dev/null)" ""
wants 0 "hash " "$FRAY" run "$image" --ticks 2 --record "$dir/d/x" --save "$dir/d/y"
wants 0 "hash " "$FRAY" run "$image" --ticks 2 --record "$dir/d/x" --save /dev/null
# the key is an input too, by its name or a link
cp "$key" "$dir/d/summary.txt" && ln -s summary.txt "$dir/d/frame_00800.png"
before=$(cksum <"$key")
wants 2 "--report $dir/d goes over the file of --key $dir/d/summary.txt" "$FRAY" run "$image" --log "$keyed" --key "$dir/d/summary.txt" --report "$dir/d"
wants 2 "-o $dir/d goes over the file of --key $dir/d/summary.txt" "$FRAY" render "$image" --log "$keyed" --key "$dir/d/summary.txt" -o "$dir/d"
mkdir "$dir/e" && ln -s ../d/summary.txt "$dir/e/sheet.png"
wants 1 "sheet.png: cannot be written: this command reads it" "$FRAY" render "$image" --log "$keyed" --key "$dir/d/summary.txt" --at 1ms --size 64x64 -o "$dir/e"
is "the key" "$(cksum <"$dir/d/summary.txt")" "$before"
# - is no name for an output
for use in "run $image --ticks 2 --record" "run $image --ticks 2 --save" "run $image --ticks 2 --report" "scene $small -o" "render $image -o" "hand tests/determinism/small.hand -o" "bench $image --json"; do
  # shellcheck disable=SC2086
  wants 2 "${use##* } -, expected a name (./- for a file called so)" "$FRAY" $use -
done
# nor is standard output, which would have both
: >"$dir/both"
for use in "scene $small -o" "run $image --ticks 3 --record" "run $image --ticks 3 --save"; do
  # shellcheck disable=SC2086
  wants 2 "${use##* } /dev/stdout, expected a name of another file: standard output has what is printed" "$FRAY" $use /dev/stdout
  # shellcheck disable=SC2086
  wants 2 "${use##* } $dir/both, expected a name of another file" sh -c 'to=$1 && shift && exec "$@" "$to" >>"$to"' sh "$dir/both" "$FRAY" $use
done
is "what was printed into it" "$(cat "$dir/both")" ""
is "a file called so" "$(ls -d ./- 2>/dev/null)" ""
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$dir/case.obj"
{ cat "$small" && echo 'mesh m { obj "case.obj" at 0 -3 0 cm }'; } >"$dir/mesh.scene"
wants 1 "case.obj: cannot be written: this command reads it" "$FRAY" scene "$dir/mesh.scene" -o "$dir/case.obj"
is "a mesh" "$(wc -l <"$dir/case.obj")" 4
# through a link the file is replaced, with its rights, and the link stays
chmod 640 "$dir/in.log"
wants 0 "hash " "$FRAY" run "$image" --ticks 3 --record "$dir/soft.log"
if [ -L "$dir/soft.log" ]; then pass; else fail "a link was replaced"; fi
is "its rights" "$(ls -l "$dir/in.log" | cut -c 1-10)" "-rw-r-----"
wants 0 "verified 3 ticks" "$FRAY" verify "$dir/in.log" --scene "$image"
wants 0 "hash " "$FRAY" run "$image" --ticks 3 --record /dev/null

# ---- input without an end, or of another kind
mkfifo "$dir/pipe"
for use in "run INPUT" "info INPUT" "scene INPUT -o $dir/x.img" "run $image --log INPUT" "verify INPUT --scene $image" \
  "verify INPUT --scene $image --cut" "hand -o $dir/x.log INPUT"; do
  for input in "/dev/zero: cannot be read: it is a device or a socket, expected a file" "$dir/pipe: cannot be read: it is a pipe without a writer" "$dir: cannot be read: it is a folder"; do
    # shellcheck disable=SC2046
    wants 2 "$input" timeout 20 "$FRAY" $(echo "$use" | sed "s|INPUT|${input%%:*}|")
  done
done
rm "$dir/case.obj"
ln -s /dev/zero "$dir/case.obj"
wants 2 "case.obj: cannot be read: it is a device" timeout 20 "$FRAY" scene "$dir/mesh.scene" -o "$dir/x.img"
truncate -s 100G "$dir/long" 2>/dev/null || : # most file systems hold it in no space
if [ -s "$dir/long" ]; then
  wants 2 "long: has more than 1024 MiB" "$FRAY" run "$dir/long"
  wants 2 "long: has more than 16 MiB" "$FRAY" hand -o "$dir/x.log" "$dir/long"
fi
rm -f "$dir/long"
head -c 100000 /dev/zero >"$dir/zeros.img"
wants 2 "zeros.img: is neither an image, which begins with FRAY, nor a scene" "$FRAY" run "$dir/zeros.img"
wants 2 "s.img: is an image, expected a scene" "$FRAY" scene "$image" -o "$dir/x.img"
wants 0 "verified 3 ticks" sh -c "cat $dir/in.log | $FRAY verify /dev/stdin --scene $image"

# ---- a signal: the run ends after a whole tick, and its log and report are those so far
# a shell starts what is in the background with SIGINT ignored, nohup all with SIGHUP, and what is ignored stays so;
# a run that no signal ends, ends after its ticks, and its exit code says so
with_signals=
sent=HUP,INT,TERM,QUIT,ALRM,USR1,USR2,XCPU
if env --default-signal=$sent true 2>/dev/null; then with_signals="env --default-signal=$sent"; fi
until_there() { # PATTERN: a minute at most
  tries=0
  # shellcheck disable=SC2086
  until ls $1 >/dev/null 2>&1 || [ $tries -eq 1200 ]; do sleep 0.05 && tries=$((tries + 1)); done
}
signalled() { # SIGNAL CODE
  rm -rf "$dir/so_far" && mkdir "$dir/so_far"
  # shellcheck disable=SC2086
  $with_signals "$FRAY" run "$image" --ticks 1000000 --record "$dir/so_far/r.log" --report "$dir/so_far/report" --save "$dir/so_far/r.img" >"$cd_work/said" 2>&1 &
  run=$!
  until_there "$dir/so_far/.fray-*"
  sleep 0.3
  kill "-$1" $run
  code=0 && wait $run || code=$?
  is "a run under SIG$1: exit" "$code" "$2"
  ticks=$(sed -n 's/^hash [0-9a-f]* ticks \([0-9]*\) .*/\1/p' "$cd_work/said")
  wants 0 "verified $ticks ticks, hash $(sed -n 's/^hash \([0-9a-f]*\) .*/\1/p' "$cd_work/said")" "$FRAY" verify "$dir/so_far/r.log" --scene "$image"
  wants 0 "at tick $ticks" "$FRAY" info "$dir/so_far/r.img"
  if grep -q '^ended  *by signal' "$dir/so_far/report/summary.txt" && [ -s "$dir/so_far/report/frame_$(printf %05d "$ticks").png" ]; then
    pass
  else
    fail "the report of a run under SIG$1: $(ls "$dir/so_far/report")"
  fi
  is "files beside it" "$(ls -A "$dir/so_far" | tr '\n' ' ')" "r.img r.log report "
}
signalled TERM 143
signalled HUP 129
if [ -n "$with_signals" ]; then signalled INT 130; else not_run "a run under SIGINT" "coreutils 8.31"; fi
# each signal: of a run the recording so far, of another command nothing
ends() { # SIGNAL NUMBER
  rm -rf "$dir/so_far" && mkdir "$dir/so_far"
  # shellcheck disable=SC2086
  $with_signals "$FRAY" run "$image" --ticks 1000000 --record "$dir/so_far/r.log" >/dev/null 2>&1 &
  run=$!
  # shellcheck disable=SC2086
  $with_signals "$FRAY" bench "$image" --ticks 100000 --json "$dir/so_far/b.json" >/dev/null 2>&1 &
  bench=$!
  until_there "$dir/so_far/.fray-$run-0" && until_there "$dir/so_far/.fray-$bench-0"
  sleep 0.2
  kill "-$1" $run $bench
  code=0 && wait $run || code=$?
  is "a run under SIG$1: exit" "$code" $((128 + $2))
  code=0 && wait $bench 2>/dev/null || code=$?
  is "a bench under SIG$1: exit" "$code" $((128 + $2))
  is "files after SIG$1" "$(ls -A "$dir/so_far" | tr '\n' ' ')" "r.log "
}
ulimit -c 0 # SIGQUIT and SIGXCPU write one
for signal in 10:USR1 12:USR2 14:ALRM 24:XCPU; do ends "${signal#*:}" "${signal%:*}"; done
if [ -n "$with_signals" ]; then ends QUIT 3; else not_run "a run under SIGQUIT" "coreutils 8.31"; fi
# while the report is written: whole pictures, and no more of them
rm -rf "$dir/so_far" && mkdir "$dir/so_far"
"$FRAY" run "$image" --ticks 20 --report "$dir/so_far" --record "$dir/so_far/r.log" >"$cd_work/said" 2>&1 &
run=$!
until_there "$dir/so_far/frame_00000.png"
kill -TERM $run
code=0 && wait $run || code=$?
is "a report under SIGTERM: exit" "$code" 143
if grep -q "so_far: not all of the report: signal 15 ended it" "$cd_work/said"; then pass; else fail "a report under SIGTERM: $(cat "$cd_work/said")"; fi
is "its last picture" "$(ls "$dir/so_far/frame_00020.png" "$dir/so_far/sheet.png" 2>/dev/null)" ""
is "what is left aside" "$(ls -d "$dir/so_far"/.fray-* 2>/dev/null)" ""
if grep -q "^ticks  *20 " "$dir/so_far/summary.txt"; then pass; else fail "its summary"; fi
wants 0 "verified 20 ticks" "$FRAY" verify "$dir/so_far/r.log" --scene "$image"
