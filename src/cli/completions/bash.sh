_frames_lint() {
    local line
    COMPREPLY=()
    while IFS= read -r line; do
        COMPREPLY+=("$line")
    done < <(FRAMES_LINT_COMPLETE=bash _CLAP_COMPLETE_INDEX=$COMP_CWORD PROGRAM -- "${COMP_WORDS[@]}" 2>/dev/null)
    # File names are quoted where necessary.
    if [[ -e ${COMPREPLY[0]} ]]; then compopt -o filenames 2>/dev/null; fi
    # A word continues after a folder and after `json=`.
    if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *[=/] ]]; then compopt -o nospace 2>/dev/null; fi
}
complete -o bashdefault -o default -F _frames_lint frames-lint
