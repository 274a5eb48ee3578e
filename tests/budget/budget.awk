# SPDX-License-Identifier: Apache-2.0
# Files: what the compilers are (COMMAND VERSION...), the budgets, the measured figures; all lines of
# `prefix`. Lines out: a mark (ok, grown, shrunk, over, gone, new, other, unnamed) and then what to print.
function change(now, then) {
  if (then == 0) return now == 0 ? 0 : 100
  return (now - then) * 100 / then
}
function row(mark, name, text) { printf "%s %-34s %s\n", mark, name, text }

FILENAME == versions { version[$1] = $0; next }
/^#/ || NF == 0 { next }
FILENAME == budgets && $1 == "compiler" { wanted[$2] = substr($0, index($0, $2)); next }
index($1, prefix) != 1 { next }
FILENAME == budgets { budget[$1] = $2; by[$1] = $3; asked[$1] = $4; order[++count] = $1; next }
{
  measured[$1] = $2
  if (!($1 in budget)) row("new", $1, $2 " is in no budget")
}
END {
  for (n = 1; n <= count; ++n) {
    name = order[n]
    was_measured = name in measured
    now = measured[name]
    if (asked[name] != "" && was_measured && now > asked[name])
      row("over", name, now " of at most " asked[name] " asked")
    if (version[by[name]] != wanted[by[name]]) {
      if (!(by[name] in told) && wanted[by[name]] != "") print "other", wanted[by[name]]
      if (!(by[name] in told) && wanted[by[name]] == "") print "unnamed", "no line 'compiler " by[name] "'"
      told[by[name]] = 1
    } else if (!was_measured) {
      row("gone", name, "was not measured, the budget is " budget[name])
    } else {
      percent = change(now, budget[name])
      mark = percent > 1 ? "grown" : (percent < -1 ? "shrunk" : (asked[name] != "" ? "asked" : "ok"))
      row(mark, name, sprintf("%9d  budget %9d  %+6.1f %%%s", now, budget[name], percent,
                              asked[name] != "" ? "  asked: at most " asked[name] : ""))
    }
  }
}
