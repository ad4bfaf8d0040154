#compdef frames-lint
_frames_lint() {
    local line
    local -a whole begun
    for line in "${(@f)$(
        FRAMES_LINT_COMPLETE=zsh _CLAP_COMPLETE_INDEX=$((CURRENT - 1)) _CLAP_IFS=$'\n' PROGRAM -- "${(@Q)words}" 2>/dev/null
    )}"; do
        # A word continues after a folder and after `json=`.
        case ${line%%:*} in
            '') ;;
            *[=/]) begun+=("$line") ;;
            *) whole+=("$line") ;;
        esac
    done
    (( $#whole )) && _describe -V values whole
    (( $#begun )) && _describe -V values begun -S ''
}
if [[ $funcstack[1] == _frames-lint ]]; then _frames_lint "$@"; else compdef _frames_lint frames-lint; fi
