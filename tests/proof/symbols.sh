#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What rt may ask of its surroundings, and that it has no float in it, by the compiled library:
#   - undefined symbols: memcpy, memset, memmove, memcmp, and integer helpers of the compiler;
#     so no allocator, no libm, no other libc, no soft float;
#   - no object in .data, .bss or common: no globals;
#   - x86-64: no x87 instruction, and of SSE and AVX only moves, shuffles, logic and integers;
#     M3: no VFP instruction;
#   - it compiles with general registers only, and the words float and double are nowhere in rt.
# PART=2/8: the first three in the second of eight parts of the configurations.
. tests/lib/suite.sh
. tests/determinism/configs.sh

list=$(sh tests/part.sh share "${PART:-1/1}" clang-O3 s390x-O2 gcc-O3 m3-O2 i386-O2 gcc-native)
work=$FRAY_BUILD/cross/symbols
mkdir -p "$work"

allowed='^(mem(cpy|set|move|cmp)|__aeabi_mem(cpy|set|move|clr)[48]?|__aeabi_(u?ldivmod|u?idiv(mod)?|lmul|llsl|llsr|lasr|lcmp|ulcmp)|__(u?div|u?mod|u?divmod|mul|ashl|ashr|lshr|clz|ctz)[sdt]i[234]|_GLOBAL_OFFSET_TABLE_)$'

# name them, so that the reason is in the message
why() {
  case $1 in
    malloc | calloc | realloc | free | sbrk | _sbrk) echo "an allocator" ;;
    __aeabi_[fdi]2* | __aeabi_[fd]* | __*sf* | __*df* | __*tf*) echo "soft float" ;;
    *) echo "libc, libm or unknown" ;;
  esac
}

check_undefined() { # NAME LIBRARY
  "$NM" "$2" 2>/dev/null | awk 'NF == 3 { defined[$3] = 1 } NF == 2 && $1 == "U" { used[$2] = 1 }
    END { for (s in used) if (!(s in defined)) print s }' | sort >"$work/$1.undefined"
  bad=$(grep -Ev "$allowed" "$work/$1.undefined" || true)
  if [ -z "$bad" ]; then pass; return; fi
  for symbol in $bad; do fail "$1: rt needs $symbol ($(why "$symbol"))"; done
}

# Named objects in .data, .bss or common. (.data.rel.ro is constant: tables with pointers in them.)
globals_of() { # LIBRARY
  "$OBJDUMP" -t "$1" 2>/dev/null | awk '/file format/ { file = $1 }
    match($0, /[ \t](\.s?data|\.s?bss|\*COM\*)[^ \t]*[ \t]/) && / O / && !/\.data\.rel\.ro/ { print file $NF }'
}
check_no_globals() { # NAME LIBRARY
  bad=$(globals_of "$2")
  if [ -z "$bad" ]; then pass; else fail "$1: rt has writable globals: $bad"; fi
}

mnemonics() { # LIBRARY: each mnemonic that occurs
  "$OBJDUMP" -d --no-show-raw-insn "$1" 2>/dev/null | awk -F'\t' 'NF >= 2 && $1 ~ /:$/ { split($2, w, " "); print w[1] }' |
    sort -u
}

sse_float='^v?(add|sub|mul|div|sqrt|min|max|cmp[a-z_]*|u?comi|round|rndscale|rcp(14|28)?|rsqrt(14|28)?|hadd|hsub|addsub|dp|fn?m(add|sub|addsub|subadd)[0-9]*|range|reduce|scalef|getexp|getmant|fixupimm|fpclass)(ss|sd|ps|pd|sh|ph)[xyz]?$|^v?cvt'

check_no_float() { # NAME LIBRARY
  case $1 in
    gcc-* | clang-*) rule="^f[a-z0-9]+$|$sse_float" ;;
    m3-*) rule='^v' ;;
    *) return ;; # i386 and s390x: by their undefined symbols and by the general-registers build
  esac
  mnemonics "$2" >"$work/$1.mnemonics"
  [ -s "$work/$1.mnemonics" ] || { fail "$1: nothing was disassembled"; return; }
  bad=$(grep -E "$rule" "$work/$1.mnemonics" || true)
  if [ -z "$bad" ]; then pass; else fail "$1: float instructions in rt: $(echo $bad)"; fi
}

# The rules must find what they look for.
check_the_checks() {
  printf '#include <stdlib.h>\ndouble f(double a);\ndouble f(double a) { return a / 3 + a; }\nint seen = 1;\nstatic int hidden;\nvoid *g(void);\nvoid *g(void) { seen += ++hidden; return malloc(8); }\n' >"$work/bad.c"
  gcc -O2 -c "$work/bad.c" -o "$work/bad.o"
  found=$(objdump -d --no-show-raw-insn "$work/bad.o" | awk -F'\t' 'NF >= 2 && $1 ~ /:$/ { split($2, w, " "); print w[1] }' |
    grep -cE "$sse_float" || true)
  if [ "$found" -ge 2 ]; then pass; else fail "the rule for SSE floats finds nothing in a float program"; fi
  if nm -u "$work/bad.o" | awk '{ print $2 }' | grep -qEv "$allowed"; then pass; else fail "the rule for symbols lets malloc pass"; fi
  OBJDUMP=objdump
  if [ "$(globals_of "$work/bad.o" | wc -l)" -eq 2 ]; then pass; else fail "the rule for globals misses one"; fi
}

if have objdump && have gcc; then check_the_checks; else not_run "checks of symbols" binutils; fi
for name in $list; do
  if ! config "$name"; then
    not_run "symbols of $name" "$PACKAGES"
    continue
  fi
  config_make "$name" libfray.a || { fail "$name: does not build"; continue; }
  for tool in "$NM" "$OBJDUMP"; do have "$tool" || fail "$name: no $tool, nothing is found"; done
  library=$FRAY_BUILD/cross/$name/libfray.a
  check_undefined "$name" "$library"
  check_no_globals "$name" "$library"
  check_no_float "$name" "$library"
  printf '  %-12s needs: %s\n' "$name" "$(tr '\n' ' ' <"$work/$name.undefined")"
done

for name in gcc-O2 clang-O2; do
  config "$name" || { not_run "general registers only with $name" "$PACKAGES"; continue; }
  bad=0
  for file in rt/*/*.c; do
    $CC -std=c11 -O2 -I. -mgeneral-regs-only -c "$file" -o "$work/general.o" || bad=1
  done
  if [ $bad -eq 0 ]; then pass; else fail "$name: rt does not compile with -mgeneral-regs-only"; fi
done

# who wants no key has no cipher: nothing of it is asked for
bad=''
for file in rt/wire/port.c platform/loop.c; do
  gcc -std=c11 -O1 -I. -DFRAY_NO_AUTH -c "$file" -o "$work/plain.o" || bad="$file does not compile"
  bad="$bad$(nm -u "$work/plain.o" | awk '{ print $2 }' | grep -E '^(auth|cmac)_' || true)"
done
if [ -z "$bad" ]; then pass; else fail "-DFRAY_NO_AUTH: $bad"; fi

if words=$(grep -rnwE 'float|double|long double|_Complex' rt --include='*.c' --include='*.h'); then
  fail "the word float or double in rt: $words"
else
  pass
fi
suite_end
