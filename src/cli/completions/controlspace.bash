# Completion of controlspace for bash: commands and options as its own --help names them, values as
# `controlspace list` does, and files.
_controlspace() {
    local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
    local names= prefix=
    if [ "$COMP_CWORD" -eq 1 ]; then
        names=$("$program" --help 2>/dev/null |
            awk '/^Subcommands:/ { on = 1; next } /^$/ { on = 0 } on && /^  [a-z]/ { print $1 }')
        names+=' --help --version'
    elif [[ $word == -* ]]; then
        names=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null |
            grep -oE '^  (-[a-z],)?--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+')
    elif [[ $before == --* ]]; then
        # The section of the option, as "Splits of kd-trees (--splits)".
        names=$("$program" list 2>/dev/null |
            awk -v option="($before)" '/^[^ ]/ { on = index($0, option) } on && /^ / { print $1 }')
        [[ $word == *,* ]] && prefix=${word%,*},
    fi
    # Without names, COMPREPLY stays empty and bash completes files.
    mapfile -t COMPREPLY < <(compgen -P "$prefix" -W "$names" -- "${word#"$prefix"}")
}
complete -o default -o bashdefault -F _controlspace controlspace
