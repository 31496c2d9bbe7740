#!/bin/sh
# Every remedy that the library names in an error is a field of an options struct. Usage: remedies.sh SOURCE
set -u
cd "$1" || exit 1
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT

# The fields of structs named bat_..._options, then those of all structs.
fields()
{
    sed -e 's|//.*||' include/batten/*.h | awk -v ending="$1" '
        $1 == "typedef" && $2 == "struct" && !/;/ { inside = $3 ~ ending "$" }
        $1 == "struct" { inside = $2 ~ ending "$" }
        /^}/ { inside = 0 }
        inside && /;/ { gsub(/\[[^]]*\]|[*,;()]/, " "); for (i = 2; i <= NF; i++) print $i }' | sort -u
}
fields _options > "$folder/options"
fields "" > "$folder/all"

# The names in the calls of error_remedy(): a name is in small letters; what it does has blanks.
find src research -name '*.c' ! -name error.c -exec cat {} + | tr '\n' ' ' | sed 's/error_remedy(/\n&/g' |
    sed -n '/^error_remedy(/s/);.*//p' | grep -oE '"[a-z_]+(\.[a-z_]+)*"' | tr -d '"' > "$folder/remedies"
count=$(wc -l < "$folder/remedies")
[ "$count" -ge 30 ] || { echo "FAILED: only $count remedies are found in src"; exit 1; }

failures=0
for remedy in $(sort -u "$folder/remedies"); do
    # The way out of a patch is another call, bat_shell_reconstruct().
    [ "$remedy" = shell ] && continue
    first=${remedy%%.*} last=${remedy##*.}
    grep -qx "$first" "$folder/options" && grep -qx "$last" "$folder/all" && continue
    echo "FAILED: no options struct has the field '$remedy'"
    failures=$((failures + 1))
done
exit $((failures > 0))
