#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What is wide runs in parts, K/N of a list: its words K, K + N, K + 2 N, and so on. All parts together have each
# word once.
#   part.sh share K/N WORD...   prints the words of that part; 1/1 has all
#   part.sh choose FILE HASH    prints the part, 1 to 8, for the commit HASH: by its first digits, or the next
#                               that was not run in this cycle, as FILE says
#   part.sh ran FILE COMMIT K   notes in FILE that part K was run
#   part.sh left FILE           prints the parts that were not run in this cycle
# A cycle ends when all eight parts were run; FILE has a line COMMIT K a run, and need not exist.
set -eu
parts=8
usage() { sed -n 's/^#   //p' "$0" >&2; exit 2; }

left() { # FILE
  cat "$1" 2>/dev/null | awk -v parts=$parts '
    $2 ~ /^[1-9]$/ && $2 <= parts { if (!($2 in ran)) ++n; ran[$2] = 1; if (n == parts) { n = 0; split("", ran) } }
    END { for (k = 1; k <= parts; k++) if (!(k in ran)) { printf "%s%d", sign, k; sign = " " } printf "\n" }'
}

[ $# -ge 2 ] || usage
verb=$1 file=$2
shift 2
case $verb in
share)
  k=${file%/*} n=${file#*/}
  case $file in *[!0-9/]* | */*/* | /* | */ | *[0-9]/0* | 0*) k=0 ;; */*) ;; *) k=0 ;; esac
  if [ "$k" = 0 ] || [ "$k" -gt "$n" ]; then
    echo "part.sh: part '$file', expected K/N with K from 1 to N, as 2/8" >&2
    exit 2
  fi
  at=0
  for word; do
    if [ $((at % n + 1)) -eq "$k" ]; then echo "$word"; fi
    at=$((at + 1))
  done ;;
choose)
  [ $# -eq 1 ] || usage
  open=" $(left "$file") "
  k=$((0x$(printf '%.4s' "$1") % parts + 1))
  while case $open in *" $k "*) false ;; *) true ;; esac; do k=$((k % parts + 1)); done
  echo $k ;;
ran)
  [ $# -eq 2 ] || usage
  mkdir -p "$(dirname "$file")"
  echo "$1 $2" >>"$file" ;;
left) left "$file" ;;
*) usage ;;
esac
