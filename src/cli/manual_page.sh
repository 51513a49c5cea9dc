#!/bin/sh
# manual_page.sh HELP2MAN PROGRAM VERSION PAGE [COMMAND]: writes the man page of a command, or of the
# program, from what it says with --help. PAGE is controlspace.1 or controlspace-COMMAND.1.
set -eu
help2man=$1 program=$2 version=$3 page=$4 command=${5-}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$program" $command --help >"$folder/help"

# help2man runs what it describes, titles the page by its name, and takes *X* for a section.
name=$(basename "$page" .1)
printf '#!/bin/sh\nsed "s/^Exit status:$/*Exit status*/" "%s"\n' "$folder/help" >"$folder/$name"
chmod +x "$folder/$name"

if [ -n "$command" ]; then
    others=controlspace
else
    others=$(awk '/^Subcommands:/ { on = 1; next } /^$/ { on = 0 }
                  on && /^  [a-z]/ { print "controlspace-" $1 }' "$folder/help")
fi
{
    echo '[SEE ALSO]'
    for other in $others; do echo ".BR $other (1)"; done
} >"$folder/include"

# NAME: the first line, as it stands in a list of pages.
says=$(sed -n '1 { s/^./\L&/; s/\.$//; p }' "$folder/help")
"$help2man" --no-info --version-string="$version" --name="$says" --include="$folder/include" \
    --output="$page" "$folder/$name"
