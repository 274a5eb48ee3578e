#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Frama-C Eva on the fixed point, the edge of the bus and the loader, with arbitrary input: 0 alarms,
# and every assertion of the harnesses valid. README.md has the assumptions.
. tests/lib/suite.sh

work=$FRAY_BUILD/proof/eva
mkdir -p "$work"
common='-c11 -eva -eva-plevel 9000 -warn-right-shift-negative'

small='-DWARPS=2 -DWEFTS=2 -DSPARE=1 -DHELD=1 -DLINK_BATCHES=2 -DBEND_BATCHES=0 -DSHEAR_BATCHES=1 -DKEYS=2'
square='-DWARPS=3 -DWEFTS=3 -DSPARE=2 -DHELD=2 -DLINK_BATCHES=2 -DBEND_BATCHES=1 -DSHEAR_BATCHES=1 -DKEYS=2'
long='-DWARPS=2 -DWEFTS=4 -DSPARE=0 -DHELD=3 -DLINK_BATCHES=2 -DBEND_BATCHES=1 -DSHEAR_BATCHES=1 -DKEYS=1'

# Where states are kept apart: in what refuses by return, and nowhere that a loop would double them.
header='headers:50,directories:50,loads_of:100,store_shape:100,load:100,fray_open:100,readable_in_place:10,read_header:1000,check_version:100,check_options:200,check_directory:200'
values='worlds:1000,validate:1000,image_validate:5000,image_words_in_range:400,counts_fit:100,link_classes_good:50,spring_classes_good:50,body_good:100,body_sizes_good:100,orthonormal:200,keys_good:50,bodies_good:2000,rigid_meshes_good:50,particles_good:500,crossings_good:100,ids_good:300,batches_good:50,canonical_ids_good:100,spring_is_canonical:30,yarn_grid_ends:20'
port='port_read_command:20,port_read_pose:20,port_accept_pose:20,sequence_take:20,codec_read_pose:5,codec_read_command:5,port_take:0'

options_of() { # FILE MAIN: sets files, options
  case $1-$2 in
    eva_fx-*) files='' options='-eva-precision 1 -eva-slevel 100' ;;
    eva_wire-ports)
      files='rt/wire/*.c rt/base/*.c'
      options="-eva-precision 0 -eva-auto-loop-unroll 24 -eva-widening-delay 20 -eva-split-return full -eva-slevel 0 -eva-slevel-function $port" ;;
    eva_wire-*)
      files='rt/wire/*.c rt/base/*.c'
      options='-eva-precision 3 -eva-auto-loop-unroll 4096 -eva-widening-delay 20 -eva-split-return full -eva-slevel 100' ;;
    eva_image-*)
      files='rt/base/*.c'
      options="-eva-precision 0 -eva-split-return auto -eva-auto-loop-unroll 8192 -eva-min-loop-unroll 160 -eva-split-return-function readable_in_place:0:1 -eva-slevel 0 -eva-slevel-function $header" ;;
    eva_validate-*)
      files='rt/image/image.c rt/image/image_table.c rt/image/validate_yarns.c rt/image/view.c rt/image/work_bound.c rt/state/yarn_grid.c rt/image/state_hash.c rt/state/world.c rt/state/crossing.c rt/base/*.c'
      options="-eva-precision 0 -eva-split-return auto -eva-auto-loop-unroll 100 -eva-min-loop-unroll 64 -eva-slevel 0 -inline-calls yarn_grid_link_at -eva-slevel-function $values" ;;
  esac
}

# NAME FILE MAIN MACHINE DEFINES OPTIONS...: sets alarms, unproven
analyse() {
  name=$1 file=$2 main=$3 machine=$4 defines=$5
  shift 5
  options_of "$file" "$main"
  # shellcheck disable=SC2086
  frama-c -machdep "$machine" -cpp-extra-args="-iquote $work/broken -I. $defines" $common $options "$@" \
    -main "$main" "tests/proof/$file.c" $files >"$work/$name.log" 2>&1 || true
  alarms=$(sed -n 's/^ *\([0-9]*\) alarms\{0,1\} generated.*/\1/p' "$work/$name.log")
  unproven=$(awk '/^ *(Assertions|Preconditions) / { n += $4 + $6 } END { print n + 0 }' "$work/$name.log")
  reached=$(sed -n 's/.*, \([0-9]*\) statements reached (out of \([0-9]*\)).*/\1 of \2/p' "$work/$name.log")
  if grep -q 'User Error' "$work/$name.log"; then alarms=''; fi
}

prove() { # WORDS, then as analyse
  words=$1
  shift
  began=$(date +%s)
  analyse "$@"
  printf '  %-52s %-12s %11s statements %2s alarms %2s unproven %4s s\n' "$words" "$4" "$reached" \
    "${alarms:-?}" "$unproven" "$(($(date +%s) - began))"
  if [ "${alarms:-1}" = 0 ] && [ "$unproven" = 0 ]; then pass; else
    fail "$words: $(grep -A2 -E 'eva:alarm|User Error' "$work/$1.log" | head -n 12)"
  fi
}

# The loader without one of its checks must raise alarms.
refute() { # WORDS LINE-OF-VALIDATE NAME ...
  words=$1 pattern=$2
  shift 2
  mkdir -p "$work/broken/rt/image"
  sed "s/$pattern/0/" rt/image/validate.c >"$work/broken/rt/image/validate.c"
  if cmp -s rt/image/validate.c "$work/broken/rt/image/validate.c"; then
    fail "$words: no '$pattern' in rt/image/validate.c"
  else
    analyse "$@"
    printf '  %-52s %-12s %24s %2s alarms, as it must\n' "$words" "$4" '' "${alarms:-?}"
    if [ "${alarms:-0}" -gt 0 ]; then pass; else fail "$words: no alarm"; fi
  fi
  rm -rf "$work/broken"
}

suite_needs 'Eva' frama-c-base frama-c
rm -rf "$work/broken"
prove 'fixed point, vectors, random: any value' fx eva_fx operations gcc_x86_64 ''
prove 'fixed point, 32-bit machine' fx32 eva_fx operations gcc_x86_32 ''
prove 'codec: any frame in' decodes eva_wire decodes gcc_x86_64 ''
prove 'codec: any message out' encodes eva_wire encodes gcc_x86_64 ''
prove 'port: any frames, any number' ports eva_wire ports gcc_x86_64 ''
prove 'port: counters of a hand, any of them' sequences eva_wire sequences gcc_x86_64 ''
prove 'port: outputs of any tick' senders eva_wire senders gcc_x86_64 ''
prove 'authenticated lanes: any frames, any number' lanes eva_wire lanes gcc_x86_64 ''
prove 'authenticated groups: any frames, any number' groups eva_wire groups gcc_x86_64 ''
prove 'auth_gate, FD: any frames, any number' auth_gates_fd eva_wire auth_gates_fd gcc_x86_64 ''
prove 'auth_gate, CLASSIC: any frames, any number' auth_gates_classic eva_wire auth_gates_classic gcc_x86_64 ''
prove 'image: any header, no unsigned sum wraps' headers eva_image headers gcc_x86_64 '' -warn-unsigned-overflow
prove 'image: any header, any directory' directories eva_image directories gcc_x86_64 ''
prove 'image: any bytes to memory, and saved again' loads eva_image loads gcc_x86_64 ''
prove 'image: any bytes with meshes, and saved again' meshes eva_image loads_meshes gcc_x86_64 ''
prove 'image: any bytes with self-collision, saved again' selves eva_image loads_yarn_collision gcc_x86_64 ''
prove 'image: any bytes with triangles that meet each other, saved again' layers eva_image loads_triangle_collision gcc_x86_64 ''
prove 'image: any bytes with blades, and saved again' blades eva_image loads_blades gcc_x86_64 ''
prove 'image: any bytes with handles, and saved again' handles eva_image loads_handles gcc_x86_64 ''
prove 'world: any scalars' counts eva_validate counts gcc_x86_64 "$small"
prove 'world: any values, 2 x 2' worlds22 eva_validate worlds gcc_x86_64 "$small"
prove 'world: any values, 2 x 4' worlds24 eva_validate worlds gcc_x86_64 "$long"
prove 'world: any values, 3 x 3' worlds33 eva_validate worlds gcc_x86_64 "$square"
prove 'world: any values, 3 x 3, 16-bit ids, 32-bit machine' worlds33s eva_validate worlds gcc_x86_32 "$square -DFRAY_ID_BITS=16"
refute 'the same without the check of row numbers' 'w->woven.canonical_id\[row\] >= rows' broken1 eva_validate worlds gcc_x86_64 "$small"
refute 'the same without the check of keys' 'k->keyframe_first > keys - k->keyframes' broken2 eva_validate worlds gcc_x86_64 "$small"
suite_end
