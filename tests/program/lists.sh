#!/bin/sh
# Every name that `batten list` prints stands in the documentation.
# Usage: lists.sh BATTEN DOCS
set -u
batten=$1
docs=$2
failures=0
for list in schemes spaces formats models parameterizations shapes results; do
    names=$("$batten" list $list | grep -v '^ ' | cut -d ' ' -f 1)
    [ -n "$names" ] || { echo "FAILED: batten list $list prints nothing"; failures=$((failures + 1)); }
    for name in $names; do
        # In backticks, also with settings (`learned:fairness=1`) or as an ending (`.csv`); on a line of code that begins with
        # the program's name; or, as formats are, in a heading.
        grep -rqE --include='*.md' "\`([^\`]* )?\.?$name([:, ][^\`]*)?\`|^ *batten [^|]*[ |]$name( |\$)" "$docs" && continue
        grep -rqiE --include='*.md' "^#+ (.* )?$name\$" "$docs" && continue
        echo "FAILED: no page of $docs names \`$name\` of batten list $list"
        failures=$((failures + 1))
    done
done
[ $failures -eq 0 ]
