#!/bin/sh
# The help of all verbs, the completion of shells and the manual pages, which come from the tables of options.
# Usage: help.sh BATTEN
set -u
batten=$1
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

fail()
{
    echo "FAILED: $1"
    failures=$((failures + 1))
}

# The verbs, as the overview names them; those of trainings have two words.
"$batten" --help | sed -n 's/^  \(train [a-z]*\|[a-z]*\)  *[a-z].*/\1/p' > verbs
[ "$(wc -l < verbs)" -ge 15 ] || fail "the overview names $(wc -l < verbs) verbs"

# Each help has an example, and no line of more than 100 characters. The short one shows at most 16 options, the other all.
while read -r verb; do
    for all in '' all; do
        # shellcheck disable=SC2086
        "$batten" $verb --help $all > help || fail "batten $verb --help $all"
        [ "$(wc -L < help)" -le 100 ] || fail "batten $verb --help $all has a line of $(wc -L < help) characters"
        grep -q "^usage: batten $verb" help || fail "batten $verb --help $all does not begin with the usage"
        grep -q '^Example$' help || fail "batten $verb --help $all has no example"
        ! grep -q ' $' help || fail "batten $verb --help $all has blanks at the end of a line"
        grep -c '^  \(-o, \)\?--' help > "count$all"
    done
    [ "$(cat count)" -le 16 ] || fail "batten $verb --help shows $(cat count) options"
    [ "$(cat count)" -le "$(cat countall)" ] || fail "batten $verb --help all shows less than --help"
    # shellcheck disable=SC2086
    "$batten" help $verb | grep -q "^usage: batten $verb" || fail "batten help $verb"
done < verbs
"$batten" curve --help | grep -q '^Method$' || fail "the help of curve has no groups"
"$batten" curve --help all | grep -q '^  --corner-angle A  ' || fail "the whole help of curve lacks --corner-angle"
"$batten" help curve all | grep -q '^  --corner-angle A  ' || fail "batten help curve all"

# Completion by a real bash: a verb, an option, and the value of an option.
cat > complete.bash <<'END'
source ./batten.bash
complete_words()
{
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    COMPREPLY=()
    _batten
    echo "${COMPREPLY[*]}"
}
complete_words batten mot
complete_words batten decimate --min-q
complete_words batten mesh a.obj --scheme catm
complete_words batten train me
complete_words batten train mesh --pai
complete_words batten list form
complete_words batten shape cag
complete_words batten curve a.ge
END
PATH=$(dirname "$batten"):$PATH
export PATH
"$batten" completion bash > batten.bash || fail "batten completion bash"
if command -v bash > /dev/null; then
    bash complete.bash > completed 2>&1
    printf '%s\n' motion --min-quality catmull-clark mesh --pairs formats cage '' > expected
    cmp -s completed expected || fail "bash completes $(paste -sd'|' completed) instead of $(paste -sd'|' expected)"
fi
"$batten" completion zsh > _batten || fail "batten completion zsh"
"$batten" completion fish > batten.fish || fail "batten completion fish"
if command -v zsh > /dev/null; then zsh -n _batten || fail "zsh cannot read its completion"; fi
if command -v fish > /dev/null; then fish -n batten.fish || fail "fish cannot read its completion"; fi
grep -q "'--max-edge\[a stop, edge by edge\\\\: " _batten || fail "a colon of a zsh description is not escaped"
grep -q "the Earth'\\\\''s" _batten || fail "an apostrophe of a zsh description is not escaped"
grep -q "the Earth\\\\'s" batten.fish || fail "an apostrophe of a fish description is not escaped"

# Manual pages: one of the program and one of each verb, which troff reads without a warning.
mkdir man
"$batten" manual -o man || fail "batten manual -o man"
[ "$(ls man | wc -l)" -eq $(($(wc -l < verbs) + 1)) ] || fail "there are $(ls man | wc -l) manual pages"
"$batten" manual | cmp -s - man/batten.1 || fail "batten manual prints another page"
for page in man/*.1; do
    head -n 1 "$page" | grep -q '^\.TH [A-Z-]* 1 ' || fail "$page has no title"
    for section in NAME SYNOPSIS DESCRIPTION 'SEE ALSO'; do
        grep -qx "\.SH $section" "$page" || fail "$page has no section $section"
    done
    ! grep -q "^'" "$page" || fail "$page has a line that troff takes for a request"
    ! LC_ALL=C grep -q '[^ -~]' "$page" || fail "$page has a character that troff may not know"
    if command -v groff > /dev/null; then
        groff -man -ww -Tutf8 "$page" 2> warnings > shown
        [ ! -s warnings ] || fail "troff warns of $page: $(head -n 1 warnings)"
    fi
done
grep -q '^\\fB\\-\\-corner\\-angle\\fR \\fIA\\fR$' man/batten-curve.1 || fail "the page of curve lacks --corner-angle"

[ $failures -eq 0 ]
