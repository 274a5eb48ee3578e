# SPDX-License-Identifier: Apache-2.0
# counts (every second line is a piece), then lines: each piece with its instructions by stage behind `|`.
FNR == NR { if (FNR % 2 == 0) spent[FNR / 2] = $0; next }
$1 == "tick" || $1 == "storm" || $1 == "bend" || $1 == "shear" { print $0, "|", spent[++pieces]; next }
{ print }
