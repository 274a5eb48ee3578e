#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What users do wrong: each with its exit code and the words that help. And what a recording must
# not survive: a changed pose, a missing frame, another scene.
. tests/lib/suite.sh

work=$FRAY_BUILD/tests/cli
alter=$FRAY_BUILD/tests/cli/alter
rm -rf "$work.d"
mkdir -p "$work.d"
cd_work=$work.d
small=tests/scenes/small.scene

# wants CODE WORDS COMMAND...: WORDS must stand in what it says, on either stream
wants() {
  code=$1 words=$2
  shift 2
  found=0
  "$@" >"$cd_work/said" 2>&1 </dev/null || found=$?
  if [ "$found" -ne "$code" ]; then
    fail "$*: exit $found, expected $code: $(head -n 3 "$cd_work/said")"
  elif ! grep -qF -- "$words" "$cd_work/said"; then
    fail "$*: does not say '$words': $(head -n 3 "$cd_work/said")"
  else
    pass
  fi
}
# scene_says 'SED PROGRAM' WORDS: small.scene with an error in it
scene_says() {
  sed "$1" "$small" >"$cd_work/bad.scene"
  wants 2 "bad.scene:$2" "$FRAY" scene "$cd_work/bad.scene" -o "$cd_work/bad.img"
  if [ -e "$cd_work/bad.img" ]; then fail "an image was written for: $1"; fi
}

"$FRAY" scene "$small" -o "$cd_work/s.img" >/dev/null
"$FRAY" hand -o "$cd_work/s.log" tests/determinism/small.hand
image=$cd_work/s.img log=$cd_work/s.log

# ---- use
echo "--help" >"$cd_work/always"
wants 0 "usage: fray COMMAND" "$FRAY" --help
wants 0 "image format" "$FRAY" --version
for verb in scene run verify hand render info bench; do
  wants 0 "usage: fray $verb" "$FRAY" "$verb" --help
  wants 2 "--nonsense" "$FRAY" "$verb" --nonsense
  wants 0 "$verb" "$FRAY" --help
done
for verb in scene run verify hand render info; do wants 2 "fray $verb" "$FRAY" "$verb"; done
# every option is in the help text, and the help text has no others
for verb in scene run verify hand render info bench; do
  "$FRAY" "$verb" --nonsense 2>&1 | sed 's/.*options: //' | tr ' ' '\n' | LC_ALL=C sort -u >"$cd_work/options"
  "$FRAY" "$verb" --help | grep -o -e '--[a-z-]*[a-z]' -e '^ *-o ' | tr -d ' ' | cat - "$cd_work/always" | LC_ALL=C sort -u >"$cd_work/helped"
  if diff "$cd_work/options" "$cd_work/helped" >"$cd_work/said"; then pass; else fail "fray $verb --help: $(cat "$cd_work/said")"; fi
  wants 0 "usage: fray $verb" "$FRAY" help "$verb"
done
wants 2 "no command 'fly'" "$FRAY" help fly
wants 2 "usage: fray COMMAND" "$FRAY"
wants 0 "fray $(sed -n 's/^#define FRAY_VERSION "\(.*\)"$/\1/p' rt/fray.h), image format" "$FRAY" --version
wants 2 "no command 'fly'" "$FRAY" fly
wants 2 "'extra'" "$FRAY" run "$image" extra
wants 2 "--ticks '0', expected a number from 1" "$FRAY" run "$image" --ticks 0
wants 2 "--ticks 'many'" "$FRAY" run "$image" --ticks many
wants 2 "--ticks, expected a value" "$FRAY" run "$image" --ticks
wants 2 "expected a number from 0 to 7" "$FRAY" run "$image" --instance 8
wants 2 "--at a second time, expected it once" "$FRAY" render "$image" --at 1 --at 2
wants 2 "--frames '0', expected a number from 1 to 5000" "$FRAY" render "$image" --frames 0
wants 2 "--frames 7, but the run has 5 ticks" "$FRAY" render "$image" --frames 7 --for 5ms
wants 2 "--at, --every and --frames exclude each other" "$FRAY" render "$image" --frames 3 --every 10ms
wants 2 "--at, --every and --frames exclude each other" "$FRAY" render "$image" --frames 3 --at 10ms
wants 2 "--wire and --strain exclude each other" "$FRAY" render "$image" --wire --strain
wants 2 "--focus 1,2,3, expected X,Y,Z,R in cm" "$FRAY" render "$image" --focus 1,2,3
wants 2 "--focus 1,2,3,0, expected X,Y,Z,R in cm" "$FRAY" render "$image" --focus 1,2,3,0
wants 2 "--size 63x900, expected WIDTHxHEIGHT, 64 to 4096" "$FRAY" render "$image" --size 63x900
wants 2 "--view up, expected YAW,PITCH" "$FRAY" render "$image" --view up
wants 2 "--every 5, expected a time" "$FRAY" render "$image" --every 5
wants 1 "cannot be" "$FRAY" render "$image" --at 1ms -o /dev/null/x
for look in --yarn --wire; do wants 2 "$look draws the" "$FRAY" render tests/scenes/flag.scene $look --at 1ms -o "$cd_work/look"; done
wants 2 "--instance" "$FRAY" verify "$log" --scene "$image" --instance 9

# ---- frames: so many, evenly, the first and the last among them; two looks; one contact sheet
frames=$cd_work/frames
wants 0 "3 moments and sheet.png in $frames, 0 tears" "$FRAY" render "$image" --for 9ms --frames 3 --yarn --wire --size 80x64 -o "$frames"
found=$(cd "$frames" && echo *)
expected="frame_00000.png frame_00005.png frame_00009.png sheet.png wire_00000.png wire_00005.png wire_00009.png"
if [ "$found" = "$expected" ]; then pass; else fail "frames: $found, expected $expected"; fi
wants 0 "60 moments" "$FRAY" render "$image" --for 59ms --frames 60 --size 64x64 -o "$frames.many"
wants 0 "1 moments" "$FRAY" render "$image" --for 4ms --frames 1 --size 64x64 -o "$frames.one"
if [ "$(cd "$frames.one" && echo *)" = "frame_00004.png sheet.png" ]; then pass; else fail "one frame is not the last"; fi
mv "$frames" "$frames.first"
"$FRAY" render "$image" --for 9ms --frames 3 --yarn --wire --size 80x64 -o "$frames" >/dev/null
if diff -r "$frames.first" "$frames"; then pass; else fail "pictures of one run differ"; fi

# ---- files that are not there, or cannot be written
for name in none.scene none.img; do
  wants 2 "$name: cannot be opened" "$FRAY" run "$cd_work/$name"
  wants 2 "$name: cannot be opened" "$FRAY" info "$cd_work/$name"
done
wants 2 "none.log: cannot be opened" "$FRAY" run "$image" --log "$cd_work/none.log"
wants 2 "none.log: cannot be opened" "$FRAY" verify "$cd_work/none.log" --scene "$image"
wants 2 "none.hand: cannot be opened" "$FRAY" hand -o "$cd_work/x.log" "$cd_work/none.hand"
wants 2 "cannot be read" "$FRAY" run "$cd_work"
wants 1 "cannot be written" "$FRAY" scene "$small" -o "$cd_work/no/such.img"
wants 1 "cannot be written" "$FRAY" run "$image" --ticks 3 --record "$cd_work/no/such.log"
wants 1 "cannot be written" "$FRAY" run "$image" --ticks 3 --save "$cd_work/no/such.img"
if [ -w /dev/full ]; then
  wants 1 "cannot be written" "$FRAY" run "$image" --ticks 300 --record /dev/full
  wants 1 "cannot be written" "$FRAY" scene "$small" -o /dev/full
fi

# ---- scenes
scene_says 's/spacing/spaceing/' "12:3: found 'spaceing' (did you mean 'spacing'?), expected a key of the woven cloth: warps"
scene_says 's/12 .cm/12 s/' "12:14: found 's', expected a unit of length"
scene_says 's/-981 0 cm.s2/-981 0 cm/' "6:"
scene_says 's/warps 8/warps 1025/' "10:9: found '1025', expected 2 to 1024 for 'warps'"
scene_says 's/wefts 8/wefts 1/' "11:9: found '1', expected 2 to 1024"
scene_says 's/pin row top/pin crossing 8 0/' "22:1: found a pin at warp 8, weft 0, expected it inside the grid"
scene_says '/^woven/,/^}/d' "1:1: the scene has no cloth, expected 'woven' or 'membrane': woven { warps 16 wefts 16 spacing 12 /cm }"
scene_says 's/substeps 8/substeps 129/' "5:10: found '129', expected"
scene_says 's/substeps 8/substeps eight/' "5:10: found 'eight'"
scene_says 's/rate 1000 Hz/rate 20 kHz/' "4:6:"
scene_says 's/seed 88/seed 88 seed 9/' "7:"
scene_says 's/radius 0.1 cm/radius -1 cm/' "25:"
scene_says 's/contacts 16/contacts 9999999/' "32:"
scene_says 's/^woven/sheet/' "9:1: 'sheet' is now 'woven'"
scene_says '$d' "34:1: found the end of the file, expected '}' for limits of line 31"
printf 'scene x\ngravity 0 0 0\n' >"$cd_work/unit.scene"
wants 2 "unit.scene:2:14: found the end of the line, expected a unit" "$FRAY" scene "$cd_work/unit.scene"
cp "$small" "$cd_work/array.scene"
wants 0 "array.c: cloth, an array of " "$FRAY" scene "$cd_work/array.scene" --emit-c cloth
if [ -e "$cd_work/array.img" ]; then fail "--emit-c wrote an image"; else pass; fi
# ---- meshes: mesh_says 'OBJ' 'KEYS' WORDS
mesh_says() {
  # shellcheck disable=SC2059
  printf "$1" >"$cd_work/case.obj"
  { cat "$small" && echo "mesh m { obj \"case.obj\" at 0 -3 0 cm $2 }"; } >"$cd_work/mesh.scene"
  wants 2 "$3" "$FRAY" scene "$cd_work/mesh.scene" -o "$cd_work/bad.img"
  if [ -e "$cd_work/bad.img" ]; then fail "an image was written for: $1"; fi
}
square='v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n'
mesh_says "${square}f 1 2 x\n" "" "case.obj:5:7: found 'x', expected the number of a point"
mesh_says "v 0 0\n" "" "case.obj:1:6: found the end of the line, expected 3 numbers for 'v'"
mesh_says "${square}f 1 2 3\nf 1 4 3\n" "" "case.obj:6: found two triangles that pass the edge"
mesh_says "${square}f 1 2 3 4\nl 2 4\n" "sharp named" "case.obj:6: found a line from point 2 to point 4"
mesh_says "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n" "" "case.obj:4: found a triangle of points 1, 2 and 3 that is flatter"
mesh_says "${square}f 1 2 3 4\n" "unit 20 cm" "case.obj:2: found a point too far out"
rm "$cd_work/case.obj"
wants 2 "mesh.scene:35:10: mesh 'm': $cd_work/case.obj: cannot be opened: No such file" "$FRAY" scene "$cd_work/mesh.scene" -o "$cd_work/bad.img"
mesh_says "${square}f 1 2 3 4\n" "sharp keen" "mesh.scene:35:44: found 'keen', expected off or named for 'sharp'"
# a key without effect: said, and the image is made
sed 's/tear 5 10 %/tear 5 10 % pleats 3/' "$small" >"$cd_work/idle.scene"
wants 0 "idle.scene:19:15: note: 'pleats' has no effect: 'gather' is 0" "$FRAY" scene "$cd_work/idle.scene" -o "$cd_work/idle.img"
if cmp "$cd_work/idle.img" "$image"; then pass; else fail "a note changes the image"; fi
wants 0 "note: 'pleats' has no effect" "$FRAY" run "$cd_work/idle.scene" --ticks 1
noted=$(find tests tools rt -name '*.scene' | while read -r scene; do
  "$FRAY" scene "$scene" -o "$cd_work/idle.img" 2>&1 | grep '[0-9]: note: ' || true
done)
if [ -z "$noted" ]; then pass; else fail "scenes of the repository have notes: $noted"; fi
printf 'scene x\n\001\377' >"$cd_work/binary.scene"
wants 2 "binary.scene:2:1" "$FRAY" scene "$cd_work/binary.scene"

# ---- images
: >"$cd_work/empty.img"
wants 2 "empty.img" "$FRAY" run "$cd_work/empty.img"
wants 2 "empty.img" "$FRAY" info "$cd_work/empty.img"
for bytes in 4 50 95 96 3000; do
  head -c "$bytes" "$image" >"$cd_work/cut.img"
  wants 2 "cut.img: the image is cut off" "$FRAY" run "$cd_work/cut.img"
done
for bit in 130 3000 30001 53000; do
  "$alter" flip "$image" "$bit" >"$cd_work/flipped.img"
  wants 2 "flipped.img: " "$FRAY" run "$cd_work/flipped.img"
  wants 2 "flipped.img: " "$FRAY" info "$cd_work/flipped.img"
done
"$alter" flip "$image" 30001 >"$cd_work/flipped.img"
wants 2 "the image is damaged (CRC)" "$FRAY" verify "$log" --scene "$cd_work/flipped.img"
"$alter" mend "$image" 51 >"$cd_work/version.img" # the major version, 1 to 9
wants 2 "another version of the image format" "$FRAY" run "$cd_work/version.img"
"$alter" mend "$image" 4379 >"$cd_work/field.img" # params: substeps, or what stands there
"$FRAY" info "$cd_work/field.img" >/dev/null 2>&1 || wants 2 "section 1" "$FRAY" info "$cd_work/field.img"
wants 0 "hash " "$FRAY" run "$image" --ticks 5 --save "$cd_work/saved.img"
wants 0 "at tick 5" "$FRAY" info "$cd_work/saved.img"
wants 0 "fastest      " "$FRAY" run "$image" --ticks 5 --energy "$cd_work/energy.csv"
if awk -F, 'NR == 1 { columns = NF } NF != columns { exit 1 } END { exit NR != 6 }' "$cd_work/energy.csv"; then
  pass
else
  fail "energy.csv has no head and a line a tick, all with the same columns"
fi
wants 1 "cannot be written" "$FRAY" run "$image" --ticks 3 --energy "$cd_work/no/such.csv"
wants 2 "excludes" "$FRAY" run "$image" --can vcan9 --energy "$cd_work/energy.csv"

{ cat "$image" && printf 'four'; } >"$cd_work/tail.img"
bytes=$(wc -c <"$image")
wants 0 "tail.img: note: the image ends after $((bytes)) bytes, 4 behind it are not read" "$FRAY" run "$cd_work/tail.img" --ticks 1
wants 0 "hash " "$FRAY" run "$image" --ticks 1
refutes "a note on an image of its own length" grep -q "behind it" "$cd_work/said"

# ---- logs
sed 's/$/\r/' "$log" >"$cd_work/crlf.log"
wants 2 "crlf.log:1:47: found a carriage return" "$FRAY" run "$image" --log "$cd_work/crlf.log"
head -c 20010 "$log" >"$cd_work/half.log"
wants 2 "half.log:426:" "$FRAY" run "$image" --log "$cd_work/half.log"
sed '7s/#/ /' "$log" >"$cd_work/bad.log"
wants 2 "bad.log:7:" "$FRAY" run "$image" --log "$cd_work/bad.log"
sed '9s/1000000000/10000000000000000000000/' "$log" >"$cd_work/bad.log"
wants 2 "bad.log:9:" "$FRAY" run "$image" --log "$cd_work/bad.log"
# ids of others are left alone: as if no hand were there
sed 's/ 102#/ 7FF#/' "$log" >"$cd_work/other.log"
wants 0 "tears 0" "$FRAY" run "$image" --log "$cd_work/other.log"
# a pose whose check is wrong is not taken, the run goes on
sed '300s/#../#00/' "$log" >"$cd_work/crc.log"
wants 0 "hash " "$FRAY" run "$image" --log "$cd_work/crc.log"
wants 2 "torn.hand:" "$FRAY" run tests/determinism/torn.hand

# ---- scripts
sed 's/0.6 s  2/0.6 s  200/' tests/determinism/small.hand >"$cd_work/bad.hand"
wants 2 "bad.hand:11:" "$FRAY" hand -o "$cd_work/x.log" "$cd_work/bad.hand"
sed 's/start/stat/' tests/determinism/small.hand >"$cd_work/bad.hand"
wants 2 "bad.hand:7:" "$FRAY" hand -o "$cd_work/x.log" "$cd_work/bad.hand"
sed 's/duration 0.8 s/duration 0.7 s/' tests/determinism/small.hand >"$cd_work/bad.hand"
wants 2 "bad.hand:12:3: found '0.8', expected the keyframes of a hand within the duration" "$FRAY" hand -o "$cd_work/x.log" "$cd_work/bad.hand"
sed 's/command 0.01 s/command 0.8 s/' tests/determinism/small.hand >"$cd_work/bad.hand"
wants 2 "bad.hand:7:9: found '0.8', expected commands before the duration is over" "$FRAY" hand -o "$cd_work/x.log" "$cd_work/bad.hand"

# ---- what a run says of its hands, its cloth and its end
wants 0 "input        5 frames accepted" "$FRAY" run "$image" --log "$log" --ticks 5
wants 0 "input        801 frames accepted" "$FRAY" run "$image" --log "$log"
sed '/^command/d' tests/determinism/small.hand >"$cd_work/still.hand"
"$FRAY" hand -o "$cd_work/still.log" "$cd_work/still.hand"
wants 0 "state        ready: the hands never started, no START was accepted" "$FRAY" run "$image" --log "$cd_work/still.log"
# START, and half of the poses
awk '/ 102#/ && n++ % 2 { next } { print }' "$log" >"$cd_work/half.log"
wants 0 "ready: the hands never started: after START not every hand sent 16 good poses" "$FRAY" run "$image" --log "$cd_work/half.log"
# times that go back; files of other tools that are no logs
(tail -n 400 "$log" && head -n 400 "$log") >"$cd_work/back.log"
wants 0 "back.log:401: note: the time goes back" "$FRAY" run "$image" --log "$cd_work/back.log"
printf ';$FILEVERSION=2.1\r\n;\r\n' >"$cd_work/other.trc"
wants 2 "other.trc:1: a .trc file, expected a log as candump -L writes it: convert it (can_logconvert" "$FRAY" run "$image" --log "$cd_work/other.trc"
printf 'LOGG\220\000' >"$cd_work/other.blf"
wants 2 "other.blf:1: a .blf file" "$FRAY" run "$image" --log "$cd_work/other.blf"
printf 'date Sat Nov 28 08:00:00 2026\nbase hex  timestamps absolute\n' >"$cd_work/other.asc"
wants 2 "other.asc:1: a .asc file" "$FRAY" verify "$cd_work/other.asc" --scene "$image"
wants 0 "state        operational" "$FRAY" run "$image" --log "$log"
sed 's/^right/left/' tests/determinism/small.hand >"$cd_work/left.hand"
"$FRAY" hand -o "$cd_work/left.log" "$cd_work/left.hand"
wants 0 "hand left    not in this world: its 800 poses move nothing" "$FRAY" run "$image" --log "$cd_work/left.log"
if grep -q "unknown id" "$cd_work/said"; then fail "poses of a hand that is not there are unknown ids"; else pass; fi
sed 's/columns 30/columns 8/; s/rows 20/rows 8/; s/material denim/&\n  elastic_steps_max 4/' tests/scenes/flag.scene >"$cd_work/stiff.scene"
wants 0 "stiffness: scaled to" "$FRAY" scene "$cd_work/stiff.scene" -o "$cd_work/stiff.img"
wants 0 "stiffness    scaled to" "$FRAY" run "$cd_work/stiff.img" --ticks 2
if grep -q "^work \(intact\|torn\|worst\)\|projections" "$cd_work/said"; then fail "a run of a membrane counts woven work"; else pass; fi
wants 0 "stiffness  scaled to" "$FRAY" info "$cd_work/stiff.img"
wants 0 "stiff.img: 128 triangles" "$FRAY" bench "$cd_work/stiff.img" --ticks 2 --kernel scalar
printf 'scene light\nrate 240 Hz\nsubsteps 8\nwoven { warps 8 wefts 8 spacing 16 /cm density 0.009 g/cm2 shear 0.1 g/s2 tear off }\npin row top\n' >"$cd_work/light.scene"
wants 0 "bend: 0.5062 g/s2 in place of its default of 5, as much as the rate bears" "$FRAY" scene "$cd_work/light.scene" -o "$cd_work/light.img"
if grep -q "^shear" "$cd_work/said"; then fail "a shear that the scene gives is no default"; else pass; fi
# a slit beside the last warp leaves its crossings no weft
printf 'scene corner\nsubsteps 8\niterations 4\nwoven { warps 8 wefts 8 spacing 16 /cm yarns all }\npin column right\nslit warp 0 0 1\n' >"$cd_work/corner.scene"
wants 0 "ticks 5 tears 0 pieces 3" "$FRAY" run "$cd_work/corner.scene" --ticks 5
sed '/^pin/d; /^sphere/,/^}/d' "$small" >"$cd_work/falls.scene"
wants 0 "OUT_OF_WORLD" "$FRAY" run "$cd_work/falls.scene" --ticks 2000
# a report: no plot of a force that nothing has, and yarns where the scene has them
{ cat "$small" && printf 'sphere far {\n  radius 0.1 cm\n  at 1.5 1.5 0 cm\n  move path { 0 s 1.5 1.5 0 cm 0.1 s 1.5 2 0 cm }\n}\n'; } >"$cd_work/far.scene"
wants 0 "hash " "$FRAY" run "$cd_work/far.scene" --ticks 20 --report "$cd_work/far"
if [ -s "$cd_work/far/summary.txt" ] && [ ! -e "$cd_work/far/pull.png" ]; then pass; else fail "a report of a body that pulls nothing: $(ls "$cd_work/far")"; fi
sed 's/^  tear .*/&\n  yarns on/' "$small" >"$cd_work/yarns.scene"
"$FRAY" run "$cd_work/yarns.scene" --ticks 1 --report "$cd_work/yarns" >/dev/null
"$FRAY" render "$cd_work/yarns.scene" --yarn --at 0s,1ms -o "$cd_work/as_yarns" >/dev/null
if cmp "$cd_work/yarns/frame_00001.png" "$cd_work/as_yarns/frame_00001.png"; then pass; else fail "a report of a scene with yarns shows a surface"; fi
"$FRAY" render "$cd_work/yarns.scene" --at 0s,1ms -o "$cd_work/as_ever" >/dev/null
if cmp "$cd_work/as_ever/frame_00001.png" "$cd_work/as_yarns/frame_00001.png"; then pass; else fail "a render of a scene with yarns shows a surface"; fi
# --strain of a membrane goes to the strength of its own material; to 100 N/m where it never tears
for tear in 40 100 none; do
  { sed 's/columns 30/columns 8/; s/rows 20/rows 8/; s/material denim/material own/' tests/scenes/flag.scene && echo 'material own { base denim' &&
    { [ $tear = none ] || echo "tear $tear N/m"; } && echo '}'; } >"$cd_work/strained.scene"
  wants 0 "1 moments and sheet.png in $cd_work/strain$tear, 0 tears" "$FRAY" render "$cd_work/strained.scene" --strain --at 100ms --size 320x240 -o "$cd_work/strain$tear"
done
for tear in 100 none; do
  refutes "colours of a membrane that tears at 40 N/m and at $tear" cmp -s "$cd_work/strain40/frame_00100.png" "$cd_work/strain$tear/frame_00100.png"
done
refutes "the legend of a membrane that never tears" cmp -s "$cd_work/strain100/frame_00100.png" "$cd_work/strainnone/frame_00100.png"
# a cloth in ten pieces, of which the two smallest are counted
{ sed 's/warps 8/warps 10/' "$small"; for warp in 0 1 2 3 4 5 6 7 8; do echo "slit warp $warp 0 7"; done; } >"$cd_work/strips.scene"
wants 0 "             and 2 smaller ones" "$FRAY" run "$cd_work/strips.scene" --ticks 1
wants 0 "attached to body 0 (right hand)" "$FRAY" run "$image" --ticks 1

# ---- recordings
record=$cd_work/r.log
wants 0 "hash " "$FRAY" run "$image" --log "$log" --record "$record"
last=$(tail -n 1 "$cd_work/said")
hash=$(echo "$last" | cut -d' ' -f2)
wants 0 "verified 800 ticks, hash $hash" "$FRAY" verify "$record" --scene "$image"
wants 0 "verified 800 ticks, hash $hash" "$FRAY" verify "$record" --scene "$small"
wants 0 "$last" "$FRAY" run "$image" --log "$record"
sed '2000s/^/# gap: 7 lines are missing here, the disk was too slow\n/' "$record" >"$cd_work/gap.log"
wants 1 "gap.log:2000: the recording has a gap: 7 lines are missing here" "$FRAY" verify "$cd_work/gap.log" --scene "$image"
wants 0 "verified " "$FRAY" verify "$cd_work/gap.log" --scene "$image" --cut
"$FRAY" run "$image" --log "$record" --record "$cd_work/again.log" >/dev/null
if cmp "$record" "$cd_work/again.log"; then pass; else fail "the recording of a recording differs"; fi

changed() { # pose of this tick changed: line of the log
  "$alter" pose "$record" "$1" 1 "$2" >"$cd_work/pose.log"
  diff "$record" "$cd_work/pose.log" | sed -n '1s/c.*//p'
}
for tick in 11 170 300 799; do
  for axis in 0 1 2; do
    line=$(changed "$tick" "$axis")
    wants 1 "tick $tick differs" "$FRAY" verify "$cd_work/pose.log" --scene "$image"
    if head -n 1 "$cd_work/said" | grep -q "^tick $tick differs"; then pass; else fail "tick $tick axis $axis: another tick is named first"; fi
    sed "${line}d" "$record" >"$cd_work/missing.log"
    wants 1 "tick $tick consumed a POSE right" "$FRAY" verify "$cd_work/missing.log" --scene "$image"
  done
done

# without_line PATTERN WORDS: the first line that matches is gone
without_line() {
  line=$(grep -n "$1" "$record" | head -n 1 | cut -d: -f1)
  sed "${line}d" "$record" >"$cd_work/missing.log"
  wants 1 "$2" "$FRAY" verify "$cd_work/missing.log" --scene "$image"
}
next=$(($(grep -n ' 080#2D010000' "$record" | cut -d: -f1) - 1))
without_line ' 080#2C010000' "missing.log:$next: SYNC of tick 301, expected tick 300: a SYNC is missing"
without_line ' 182#' "a FORCE or a SYNC is missing"
without_line ' 010#' "whose COMMAND is not in the log"
without_line ' 011#' "has no ACK"
without_line ' 701#' "differs: STATUS"
without_line ' 200#' "TEAR"
# altered NAME 'SED PROGRAM' CODE WORDS [OPTION...]: tests/unit/test_verify has every kind of change
altered() {
  name=$1 program=$2 code=$3 words=$4
  shift 4
  sed "$program" "$record" >"$cd_work/$name.log"
  refutes "$name: nothing was changed" cmp -s "$record" "$cd_work/$name.log"
  wants "$code" "$words" "$FRAY" verify "$cd_work/$name.log" --scene "$image" "$@"
}
line=$(grep -n ' 701#' "$record" | sed -n '3s/:.*//p')
altered status "${line}s/....\$/0900/" 1 "differs: STATUS at line $line says"
line=$(grep -n ' 080#2C010000' "$record" | cut -d: -f1)
altered twice "${line}{p;p;}" 0 "verified 800 ticks, hash $hash"
altered twice_wrong "${line}{p;s/....\$/0000/p;}" 1 "twice_wrong.log:$((line + 1)): SYNC of tick 300 says"
altered physics '1s/709#..../709#0000/' 0 "physics.log:1: made by another version of the physics (id "
altered physics_differs "1s/709#..../709#0000/; ${line}d" 1 "a SYNC is missing"
wants 1 "made by another version of the physics (id " "$FRAY" verify "$cd_work/physics_differs.log" --scene "$image"
altered unstated 1d 0 "unstated.log: does not state its physics (no IDENTITY)"
line=$(wc -l <"$record")
altered open "${line}d" 1 "tick 799 has no hash, expected a closing SYNC behind it"
wants 0 "verified 799 ticks" "$FRAY" verify "$cd_work/open.log" --scene "$image" --cut
wants 0 "cut off: tick 799 has no hash, it and what follows is not verified" "$FRAY" verify "$cd_work/open.log" --scene "$image" --cut
wants 0 "ticks 799 " "$FRAY" run "$image" --log "$cd_work/open.log"
for bytes in 5000 5021 5050 5071 20000 33333; do
  head -c $bytes "$record" >"$cd_work/cut.log"
  wants 1 "cut.log:" "$FRAY" verify "$cd_work/cut.log" --scene "$image"
  wants 0 "hash " "$FRAY" run "$image" --log "$cd_work/cut.log" --cut
  wants 0 "verified " "$FRAY" verify "$cd_work/cut.log" --scene "$image" --cut
done
# one whose last line is half
head -c 33333 "$record" >"$cd_work/cut.log"
wants 1 "the log is cut off (--cut takes what is whole)" "$FRAY" verify "$cd_work/cut.log" --scene "$image"
for verb in "run $image --log $cd_work/cut.log" "render $image --log $cd_work/cut.log"; do
  wants 2 "the log is cut off (--cut takes what is whole)" "$FRAY" $verb
done
wants 0 "projection" "$FRAY" bench "$image" --log "$cd_work/cut.log" --cut --ticks 2
for verb in run render bench; do wants 2 "fray $verb: --cut goes with --log" "$FRAY" $verb "$image" --cut; done
wants 0 "1 moments" "$FRAY" render "$image" --log "$cd_work/cut.log" --cut --at 1ms --size 64x64 -o "$cd_work/w"
# lines that are no frames
sed '3s/^/not a frame\n# a comment\n\nnor this\n/' "$record" >"$cd_work/lines.log"
wants 0 "lines.log: note: 2 lines are no frames, the first at line 3" "$FRAY" verify "$cd_work/lines.log" --scene "$image"
wants 0 "lines.log: note: 2 lines are no frames, the first at line 3" "$FRAY" run "$image" --log "$cd_work/lines.log"
printf 'a text\nof two lines\n' >"$cd_work/text.log"
wants 2 "text.log:1: is no frame, expected a log of a bus" "$FRAY" verify "$cd_work/text.log" --scene "$image"
wants 2 "text.log:1: is no frame, expected a log of a bus" "$FRAY" run "$image" --log "$cd_work/text.log"
line=$(grep -n ' 080#2C010000' "$record" | cut -d: -f1)
sed "${line}s/.\$/F/" "$record" >"$cd_work/hash.log"
if cmp -s "$record" "$cd_work/hash.log"; then sed "${line}s/.\$/E/" "$record" >"$cd_work/hash.log"; fi
wants 1 "tick 299 differs: SYNC at line $line says" "$FRAY" verify "$cd_work/hash.log" --scene "$image"
wants 2 "expected a recording" "$FRAY" verify "$log" --scene "$image"
wants 2 "no SYNC of instance 3" "$FRAY" verify "$record" --scene "$image" --instance 3
wants 1 "has no FORCE left" "$FRAY" verify "$record" --scene tests/determinism/torn.scene
wants 1 "r.log starts from another state than tests/determinism/torn.scene: is this the scene of the recording?" "$FRAY" verify "$record" --scene tests/determinism/torn.scene
sed 's/seed 88/seed 89/' "$small" >"$cd_work/seed.scene"
wants 1 "differs" "$FRAY" verify "$record" --scene "$cd_work/seed.scene"
sed 's/density 0.25/density 0.26/' "$small" >"$cd_work/heavy.scene"
wants 1 "differs" "$FRAY" verify "$record" --scene "$cd_work/heavy.scene"
wants 2 "no.key: cannot be opened" "$FRAY" verify "$record" --scene "$image" --key "$cd_work/no.key"
wants 2 "fray render: 0s is outside the run, expected 0.005s to" "$FRAY" render "$cd_work/saved.img" --at 0s -o "$cd_work/w"
"$FRAY" run "$cd_work/saved.img" --ticks 40 --record "$cd_work/late.log" >/dev/null
wants 1 "the recording starts with tick 5, the image with tick 0" "$FRAY" verify "$cd_work/late.log" --scene "$small"
wants 1 "the recording starts with tick 0, the image with tick 5" "$FRAY" verify "$record" --scene "$cd_work/saved.img"

# ---- 2^32 ticks: 16 before, a body whose path has ended stays, and so does the cloth; recorded, verified, drawn
cat >"$cd_work/w.scene" <<'END'
scene w
substeps 4
woven { warps 10 wefts 10 spacing 12 /cm tear 5 10 % }
pin row bottom
capsule top {
  radius 0.05 cm length 1 cm attach_within 0.02 cm
  move path { 0 s 0 0.375 0 cm 0.1 s 0 0.378 0 cm 0.2 s 0 0.3 0 cm }
}
END
"$FRAY" run "$cd_work/w.scene" --ticks 300 --save "$cd_work/w0.img" >/dev/null
"$alter" tick "$cd_work/w0.img" 4294967280 >"$cd_work/w1.img"
wants 0 "at tick 4294967280" "$FRAY" info "$cd_work/w1.img"
wants 0 "ticks 12 tears 0" "$FRAY" run "$cd_work/w1.img" --ticks 12
wants 0 "ticks 40 tears 0" "$FRAY" run "$cd_work/w1.img" --ticks 40 --record "$cd_work/w.log" --save "$cd_work/w2.img"
wants 0 "at tick 4294967320" "$FRAY" info "$cd_work/w2.img"
wants 0 "verified 40 ticks" "$FRAY" verify "$cd_work/w.log" --scene "$cd_work/w1.img"
wants 0 "ticks 40 tears 0" "$FRAY" run "$cd_work/w1.img" --log "$cd_work/w.log"
wants 1 "the recording starts with tick 4294967280, the image with tick 300" "$FRAY" verify "$cd_work/w.log" --scene "$cd_work/w0.img"
wants 1 "the recording starts with tick 4294967280, the image with tick 4294967320" "$FRAY" verify "$cd_work/w.log" --scene "$cd_work/w2.img"
grep -v ' 080#00000000' "$cd_work/w.log" >"$cd_work/gap.log"
wants 1 "SYNC of tick 4294967297, expected tick 4294967296: a SYNC is missing" "$FRAY" verify "$cd_work/gap.log" --scene "$cd_work/w1.img"
wants 0 "1 moments" "$FRAY" render "$cd_work/w1.img" --at 4294967.3s --size 64x64 -o "$cd_work/w"
if [ -e "$cd_work/w/frame_4294967300.png" ]; then pass; else fail "no picture of tick 4294967300"; fi

# ---- versions: of the image, which are refused, and of the physics, which are named
"$alter" word "$image" 1 131079 >"$cd_work/old.img"
wants 2 "another version of the image format, section 0, element 1: expected image version 3.0; version 2 needs fray 0.3 or 0.4" "$FRAY" info "$cd_work/old.img"
"$alter" word "$image" 6 1 >"$cd_work/other.img"
own=$(sed -n 's/^#define PHYSICS_ID 0x\(.*\)u$/\1/p' rt/image/physics_id.h | tr A-F a-f)
said="other.img: made by another version of the physics (id 00000001, this build has $own)"
wants 0 "$said" "$FRAY" info "$cd_work/other.img"
wants 0 "$said" "$FRAY" run "$cd_work/other.img" --ticks 3
wants 0 "$said" "$FRAY" verify "$record" --scene "$cd_work/other.img"
wants 0 "$said" "$FRAY" render "$cd_work/other.img" --at 1ms --size 64x64 -o "$cd_work/w"

# ---- keys
key=$cd_work/bus.key keyed=$cd_work/keyed.log
(umask 077 && echo 2b7e151628aed2a6abf7158809cf4f3c >"$key" && echo 000102030405060708090a0b0c0d0e0f >"$cd_work/other.key")
"$alter" seal "$record" "$key" >"$keyed"
wants 0 "verified 800 ticks, hash $hash" "$FRAY" verify "$keyed" --scene "$image" --key "$key"
wants 0 "frames have a good tag, 0 others are not used" "$FRAY" verify "$keyed" --scene "$image" --key "$key"
wants 0 "$last" "$FRAY" run "$image" --log "$keyed" --key "$key"
for verb in run render; do
  wants 2 "keyed.log: was recorded under a key, expected --key FILE" "$FRAY" $verb "$image" --log "$keyed"
done
wants 2 "keyed.log: was recorded under a key, expected --key FILE" "$FRAY" verify "$keyed" --scene "$image"
wants 2 "no tag of this log fits" "$FRAY" verify "$keyed" --scene "$image" --key "$cd_work/other.key"
wants 2 "r.log: nothing of instance 0 has a tag" "$FRAY" verify "$record" --scene "$image" --key "$key"
# a POSE that was changed is no input, and its tick has none then
line=$(grep -n ' 10A##' "$keyed" | sed -n '300s/:.*//p')
sed "${line}s/\(##5..........\)./\1F/; ${line}s/\(##5...........\)./\1E/" "$keyed" >"$cd_work/forged.log"
wants 1 "forged.log:$line: POSE_RIGHT_AUTH: a tag that does not fit" "$FRAY" verify "$cd_work/forged.log" --scene "$image" --key "$key"
wants 1 "consumed a POSE right" "$FRAY" verify "$cd_work/forged.log" --scene "$image" --key "$key"
# one that was said besides is named, and left out: forged, replayed, plain
{ sed "${line}q" "$cd_work/forged.log" && sed -n "$line,\$p" "$keyed"; } >"$cd_work/forged2.log"
wants 0 "forged2.log:$line: POSE_RIGHT_AUTH: a tag that does not fit" "$FRAY" verify "$cd_work/forged2.log" --scene "$image" --key "$key"
wants 0 "verified 800 ticks, hash $hash" "$FRAY" verify "$cd_work/forged2.log" --scene "$image" --key "$key"
{ sed "${line}q" "$keyed" && sed -n "$((line - 20)),\$p" "$keyed" | grep ' 10A##' | head -n 1 && sed -n "$((line + 1)),\$p" "$keyed"; } >"$cd_work/replayed.log"
wants 0 "replayed.log:$((line + 1)): POSE_RIGHT_AUTH: an old freshness" "$FRAY" verify "$cd_work/replayed.log" --scene "$image" --key "$key"
wants 0 "verified 800 ticks, hash $hash" "$FRAY" verify "$cd_work/replayed.log" --scene "$image" --key "$key"
{ sed "${line}q" "$keyed" && sed -n '/ 102#/{p;q;}' "$record" && sed -n "$((line + 1)),\$p" "$keyed"; } >"$cd_work/plain.log"
wants 0 "plain.log:$((line + 1)): POSE_RIGHT: no tag; not used" "$FRAY" verify "$cd_work/plain.log" --scene "$image" --key "$key"
wants 0 "verified 800 ticks, hash $hash" "$FRAY" verify "$cd_work/plain.log" --scene "$image" --key "$key"
# the file of a key
wants 2 "none.key: cannot be opened" "$FRAY" verify "$keyed" --scene "$image" --key "$cd_work/none.key"
echo 2b7e15 >"$cd_work/short.key" && chmod 600 "$cd_work/short.key"
echo 2b7e151628aed2a6abf7158809cf4f3c >"$cd_work/open.key" && chmod 644 "$cd_work/open.key"
wants 2 "short.key:1:7: not a hex digit, expected 32 hex digits" "$FRAY" verify "$keyed" --scene "$image" --key "$cd_work/short.key"
wants 2 "others than its owner have rights to this key (mode 0644), expected 0600" "$FRAY" verify "$keyed" --scene "$image" --key "$cd_work/open.key"
for use in "run $image" "hand tests/determinism/small.hand"; do
  verb=${use%% *}
  wants 2 "none.key: cannot be opened" "$FRAY" $use --can can9 --key "$cd_work/none.key"
  wants 2 "short.key:1:7: " "$FRAY" $use --can can9 --key "$cd_work/short.key"
  wants 2 "(mode 0644), expected 0600" "$FRAY" $use --can can9 --key "$cd_work/open.key"
  wants 2 "fray $verb: --classic-tags and --freshness go with --key" "$FRAY" $use --can can9 --classic-tags
  wants 2 "fray $verb: --classic-tags and --freshness go with --key" "$FRAY" $use --can can9 --freshness "$cd_work/lanes"
  wants 2 "no --freshness FILE, so this end begins anew" "$FRAY" $use --can can9 --key "$key"
  wants 2 "no/lanes: cannot be written" "$FRAY" $use --can can9 --key "$key" --freshness "$cd_work/no/lanes"
  echo "fray" >"$cd_work/$verb.lanes"
  wants 2 "$verb.lanes: not a file of freshness, expected one that --freshness wrote, or none" "$FRAY" $use --can can9 --key "$key" --freshness "$cd_work/$verb.lanes"
  wants 2 "new.$verb: a new file" "$FRAY" $use --can can9 --key "$key" --freshness "$cd_work/new.$verb"
  wants 2 "was written under another key, or altered" "$FRAY" $use --can can9 --key "$cd_work/other.key" --freshness "$cd_work/new.$verb"
done
wants 2 "not of this end of the bus, expected 'runtime fd instance 0'" "$FRAY" run "$image" --can can9 --key "$key" --freshness "$cd_work/new.hand"
wants 2 "go with --can" "$FRAY" run "$image" --log "$keyed" --key "$key" --classic-tags
wants 2 "fray run: --key goes with --can or --log" "$FRAY" run "$image" --key "$key"
wants 2 "fray render: --key goes with --log" "$FRAY" render "$image" --key "$key"
wants 2 "fray bench: --key goes with --log" "$FRAY" bench "$image" --key "$key"
wants 0 "$image" "$FRAY" bench "$image" --log "$keyed" --key "$key" --ticks 20
wants 2 "--freshness, expected a value" "$FRAY" run "$image" --can can9 --key "$key" --freshness ''
wants 2 "expected a name of at most 15 characters" "$FRAY" run "$image" --can a_name_too_long_
wants 2 "--key go with --can" "$FRAY" hand -o "$cd_work/x.log" tests/determinism/small.hand --key "$key"

. tests/cli/files.sh

# ---- bench
wants 2 "fray bench: --log goes with a scene" "$FRAY" bench --log "$log"
wants 2 "fray bench: --sweep makes its own cloth" "$FRAY" bench "$image" --sweep
wants 2 "fray bench: --sweep makes its own cloth" "$FRAY" bench --sweep --ticks 3
wants 2 "fray bench: --machine says only" "$FRAY" bench "$image" --machine
wants 2 "--ticks '0', expected a number from 1" "$FRAY" bench "$image" --ticks 0
wants 2 "--kernel abacus: expected one that this build and this machine have: scalar" "$FRAY" bench "$image" --ticks 3 --kernel abacus
wants 2 "--kernel abacus: expected" "$FRAY" bench --sweep --kernel abacus
wants 2 "--json, expected a value" "$FRAY" bench "$image" --json
wants 2 "none.scene: cannot be opened" "$FRAY" bench "$cd_work/none.scene"
if grep -q processors "$cd_work/said"; then fail "a bench without its scene prints the machine"; else pass; fi
wants 2 "none.log: cannot be opened" "$FRAY" bench "$image" --log "$cd_work/none.log"
wants 1 "such.json: cannot be written" "$FRAY" bench "$image" --ticks 3 --json "$cd_work/no/such.json"
wants 1 "such.rows: cannot be written" "$FRAY" bench "$image" --ticks 3 --rows "$cd_work/no/such.rows"
if [ -w /dev/full ]; then wants 1 "cannot be written" "$FRAY" bench "$image" --ticks 3 --json /dev/full; fi
wants 0 "processors; " "$FRAY" bench --machine
wants 0 "by stage          scalar" "$FRAY" bench "$image" --ticks 20 --kernel scalar
wants 0 "ratio to float plain, coloured, AVX2 by ids, in runs" "$FRAY" bench "$image" --log "$log" --ticks 20 --json "$cd_work/b.json" --rows "$cd_work/b.rows"
if grep -q '^tick | s, 8 x 8 | 8 | scalar |' "$cd_work/b.rows" && grep -q '^projection | s | ' "$cd_work/b.rows"; then pass; else fail "rows of a bench: $(cat "$cd_work/b.rows")"; fi
# the same hash after 20 ticks as `fray run`, for every kernel
"$FRAY" run "$image" --log "$log" --ticks 20 >"$cd_work/said"
hash20=$(sed -n '$s/^hash \([0-9a-f]*\) .*/\1/p' "$cd_work/said")
hashes=$(sed -n 's/^ *"hash": "\(.*\)"$/\1/p' "$cd_work/b.json" | sort -u)
if [ "$hashes" = "$hash20" ]; then pass; else fail "bench ends with '$hashes', run with '$hash20'"; fi
if have python3; then
  if python3 - "$cd_work/b.json" >"$cd_work/said" 2>&1 <<'END'
import json, sys
b = json.load(open(sys.argv[1]))
assert b["machine"] and b["compiler"] and b["processors"] >= 1
(s,) = b["scenes"]
assert s["ticks"] == 20 and s["warps"] == 8 and s["substeps"] == 8
k = s["kernels"]["scalar"]
assert all(us >= 0 for us in k["stage_us"].values()) and sum(k["stage_us"].values()) > 0, k
assert 0 < k["tick_us"]["least"] <= k["tick_us"]["median"] and k["worst_tick_us"] > 0, k
p = s["projections"]
for name in ("scalar", "float_plain", "float_coloured"):
    assert 0 < p["ns"][name]["least"] <= p["ns"][name]["median"], name
for name, r in p["ratios"]["scalar"].items():
    assert 0 < r < float("inf"), (name, p)
assert set(p["ratios"]["scalar"]) == {n for n in p["ns"] if n.startswith("float_")}
END
  then pass; else fail "the JSON of a bench: $(cat "$cd_work/said")"; fi
else
  not_run "JSON of a bench" python3
fi
suite_end
