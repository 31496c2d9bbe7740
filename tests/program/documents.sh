#!/bin/sh
# Check the documents:
#   - the README has at most 5,000 bytes, and all pages have at most 60,000 words;
#   - lines have at most 125 columns outside of tables;
#   - every page of docs/ can be reached from docs/index.md;
#   - every relative link, image and anchor of every Markdown file exists;
#   - the commands of the README, the first steps and the guides run, page by page and in their order;
#   - every other command names a verb and long options that exist, and runs if it is quick;
#   - the lists of names are those that the program prints (scripts/docs-tables);
#   - docs/measures.md defines the measures that the program prints, and no others.
# Commands are the lines that begin with `batten` or `printf` in blocks marked ```sh. Blocks with other marks are not run.
# Usage: documents.sh BATTEN SOURCE
set -u
LC_ALL=C
export LC_ALL
batten=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
source=$(cd "$2" && pwd)
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$source" || exit 1
run_pages="README.md docs/start.md docs/curves.md docs/motion.md docs/meshes.md docs/surfaces.md docs/cluster.md
docs/first/maps.md docs/first/robots.md docs/first/cad.md docs/first/games.md docs/first/research.md"
failures=0

fail()
{
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# The Markdown files of the project: no hidden folders, no builds.
find . \( -path './.*' -o -path './build*' -o -path ./out -o -name node_modules \) -prune -o -name '*.md' -print | sed 's|^\./||' | sort > "$scratch/pages"
test -s "$scratch/pages" || fail "there are no Markdown files in $source"

# Prints FILE, tab, LINE, tab, TARGET for every link outside of code.
links()
{
    awk '
        FNR == 1 { code = 0 }
        /^ *```/ { code = !code; next }
        code { next }
        {
            line = $0
            gsub(/`[^`]*`/, "", line)
            while (match(line, /\]\([^)]*\)/)) {
                print FILENAME "\t" FNR "\t" substr(line, RSTART + 2, RLENGTH - 3)
                line = substr(line, RSTART + RLENGTH)
            }
        }' "$@"
}

# Prints FILE#ANCHOR for every heading, as GitHub names anchors.
anchors()
{
    awk '
        FNR == 1 { code = 0; split("", seen) }
        /^ *```/ { code = !code; next }
        code || !/^#+ / { next }
        {
            text = $0
            sub(/^#+ +/, "", text)
            sub(/ +$/, "", text)
            text = tolower(text)
            gsub(/[!-,.\/:-@[-^`{-~]/, "", text)
            gsub(/ /, "-", text)
            print FILENAME "#" text (seen[text]++ ? "-" seen[text] - 1 : "")
        }' "$@"
}

# Reads the output of links(). Prints FILE, tab, LINE, tab, PATH, tab, ANCHOR of links within the project, with paths from its root.
resolve()
{
    awk -F '\t' '
        $3 ~ /^[a-z]+:/ { next }
        {
            anchor = ""
            target = $3
            if (i = index(target, "#")) {
                anchor = substr(target, i + 1)
                target = substr(target, 1, i - 1)
            }
            path = $1
            if (target != "") {
                sub(/[^\/]*$/, "", path)
                path = path target
            }
            n = split(path, part, "/")
            m = 0
            for (i = 1; i <= n; i++)
                if (part[i] == "..")
                    m--
                else if (part[i] != "." && part[i] != "")
                    kept[++m] = part[i]
            path = ""
            for (i = 1; i <= m; i++)
                path = path (i > 1 ? "/" : "") kept[i]
            print $1 "\t" $2 "\t" path "\t" anchor
        }'
}

# Prints FILE, tab, LINE, tab, KIND, tab, COMMAND. KIND is sh in blocks marked so, text in other blocks, inline elsewhere.
commands()
{
    awk '
        function found(kind, command) { print FILENAME "\t" FNR "\t" kind "\t" command }
        FNR == 1 { mark = ""; whole = "" }
        /^ *```/ {
            if (mark == "") {
                mark = $0
                gsub(/[ `]/, "", mark)
                mark = mark == "sh" ? "sh" : "text"
            } else
                mark = ""
            next
        }
        mark != "" {
            line = $0
            sub(/^ *(\$ )?/, "", line)
            whole = whole line
            if (sub(/ *\\$/, " ", whole))
                next
            if (whole ~ /^batten / || mark == "sh" && whole ~ /^printf /)
                found(mark, whole)
            whole = ""
            next
        }
        {
            line = $0
            while (match(line, /`[^`]*`/)) {
                text = substr(line, RSTART + 1, RLENGTH - 2)
                if (text ~ /^batten /)
                    found("inline", text)
                line = substr(line, RSTART + RLENGTH)
            }
        }' "$@"
}

# Size of the README.
bytes=$(($(wc -c < README.md)))
test "$bytes" -le 5000 || fail "README.md has $bytes bytes, more than 5000"

# Lists of names.
scripts/docs-tables --check "$batten" || fail "the lists of names"

# Measures: the members of the JSON objects, at the depth of one, are the names in the first column of the page's tables.
"$batten" shape cage -o "$scratch/cage.obj" --quiet || fail "no mesh to measure"
for operands in "$scratch/cage.obj" "$scratch/cage.obj $scratch/cage.obj" "examples/data/outline.csv examples/data/outline.csv"; do
    # shellcheck disable=SC2086
    "$batten" measure $operands --json | sed -n 's/^ "\([a-z0-9_]*\)":.*/\1/p'
done | sort -u > "$scratch/printed"
sed -n 's/^|\([^|]*`[^|]*\)|.*/\1/p' docs/measures.md | grep -o '`[a-z0-9_]*`' | tr -d '`' | sort -u > "$scratch/defined"
test -s "$scratch/printed" || fail "no measures"
for measure in $(comm -23 "$scratch/printed" "$scratch/defined"); do
    fail "docs/measures.md does not define $measure"
done
for measure in $(comm -13 "$scratch/printed" "$scratch/defined"); do
    fail "docs/measures.md defines $measure, which batten measure does not print"
done

# Links.
tr '\n' ' ' < "$scratch/pages" > "$scratch/list"
pages=$(cat "$scratch/list")
# Names of pages contain no blanks.
# shellcheck disable=SC2086
words=$(cat $pages | wc -w)
test "$words" -le 60000 || fail "the pages have $words words, more than 60000"
# The bytes of a character after its first count for nothing.
# shellcheck disable=SC2086
awk '{ gsub(/[\200-\277]/, "") } length > 125 && !/^\|/ { print FILENAME ":" FNR ": the line has " length " columns" }' $pages > "$scratch/wide"
while read -r line; do
    fail "$line"
done < "$scratch/wide"
# shellcheck disable=SC2086
links $pages | resolve > "$scratch/links"
# shellcheck disable=SC2086
anchors $pages > "$scratch/anchors"
while IFS='	' read -r page line path anchor; do
    if [ -n "$path" ] && [ ! -e "$path" ]; then
        fail "$page:$line: the link to $path leads nowhere"
    elif [ -n "$anchor" ] && ! grep -qxF "$path#$anchor" "$scratch/anchors"; then
        fail "$page:$line: $path has no heading #$anchor"
    fi
done < "$scratch/links"

# Pages that can be reached from the index.
awk -F '\t' '
    { count[$1]++; to[$1, count[$1]] = $3 }
    END {
        first = last = 1
        queue[1] = "docs/index.md"
        reached[queue[1]] = 1
        while (first <= last) {
            page = queue[first++]
            print page
            for (i = 1; i <= count[page]; i++)
                if (!(to[page, i] in reached)) {
                    reached[to[page, i]] = 1
                    queue[++last] = to[page, i]
                }
        }
    }' "$scratch/links" > "$scratch/reached"
for page in $pages; do
    case $page in
        docs/*) grep -qxF "$page" "$scratch/reached" || fail "$page cannot be reached from docs/index.md" ;;
    esac
done

# Runs one command line in the current folder; `batten` is the program that is tested.
mkdir "$scratch/bin"
ln -s "$batten" "$scratch/bin/batten"
run()
{
    PATH="$scratch/bin:$PATH" sh -c "$1" < /dev/null > "$scratch/output" 2>&1 || {
        fail "$2: $1"
        sed 's/^/    /' "$scratch/output"
    }
}

# Goes into a new folder for the commands of a page.
enter()
{
    folder=$scratch/run/$(echo "$1" | tr '/' '-')
    mkdir -p "$folder"
    test -e "$folder/examples" || ln -s "$source/examples" "$folder/examples"
    cd "$folder" || exit 1
}

# shellcheck disable=SC2086
commands $pages > "$scratch/commands"

# The pages whose commands run, in their order.
for page in $run_pages; do
    test -f "$page" || { fail "$page is missing"; continue; }
    enter "$page"
    awk -F '\t' -v page="$page" '$1 == page && $3 == "sh"' "$scratch/commands" > "$scratch/page"
    test -s "$scratch/page" || fail "$page has no commands"
    while IFS='	' read -r file line _ command; do
        run "$command" "$file:$line"
    done < "$scratch/page"
    cd "$source" || exit 1
done

# Prints the help of the verb of a command; what a verb trains has a help of its own.
help_of()
{
    verb=$1
    what=
    if [ "$verb" = train ]; then
        case ${2:-} in
            [a-z]*) what=$2 ;;
        esac
    fi
    cached=$scratch/help-$verb-$what
    # shellcheck disable=SC2086
    test -e "$cached" || "$batten" "$verb" $what --help all > "$cached" 2>&1 || echo "no help" > "$cached.none"
    test ! -e "$cached.none"
}

# All commands: the verb and its long options exist, and so does a published result.
"$batten" list results > "$scratch/results"
while IFS='	' read -r page line _ command; do
    # Words are split at blanks; brackets and bars of a synopsis are no part of an option.
    set -f
    # shellcheck disable=SC2046,SC2086
    set -- $(echo "$command" | tr '[]|()' '     ')
    set +f
    case ${2:-} in
        -* | '' | [A-Z]*) continue ;;
        help) continue ;;
    esac
    test "$1" = batten || continue
    shift
    help_of "$@" || { fail "$page:$line: no verb for: $command"; continue; }
    if [ "$1" = reproduce ]; then
        case ${2:-} in
            [a-z]*) grep -q "^$2 " "$scratch/results" || fail "$page:$line: there is no published result $2" ;;
        esac
    fi
    for word; do
        case $word in
            --help) ;;
            --[a-z]*) grep -q -e "${word%%=*}\$" -e "${word%%=*}[^a-z-]" "$cached" || fail "$page:$line: no option $word: $command" ;;
        esac
    done
done < "$scratch/commands"

# Quick commands of the other pages: analysis and lists, and refinement of the examples.
while IFS='	' read -r page line _ command; do
    case " $run_pages " in
        *" $page "*) continue ;;
    esac
    case $command in
        *[A-Z][A-Z]* | *…* | *...* | *'|'*) continue ;;
        'batten analyze '* | 'batten list '* | 'batten help '* | 'batten '*'examples/data/'*) ;;
        *) continue ;;
    esac
    enter quick
    run "$command" "$page:$line"
    cd "$source" || exit 1
done < "$scratch/commands"

if [ "$failures" -gt 0 ]; then
    echo "$failures failures"
    exit 1
fi
echo "$(wc -l < "$scratch/pages") pages, $(wc -l < "$scratch/links") links, $(wc -l < "$scratch/commands") commands: all right"
