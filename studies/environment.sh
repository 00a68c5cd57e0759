# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
# For scripts that source it, with $command, their name in messages, and $root set.

die() { printf '%s: %s\n' "$command" "$*" >&2; exit 1; }

# make_venv FOLDER PYTHON PACKAGE REQUIREMENTS NAME: an environment, if it is not there yet.
make_venv()
{
    local venv=$1 python=$2 package=$3 requirements=$root/studies/$4 name=$5 stamp log
    stamp="$root $(cksum < "$requirements")"
    [[ -x $venv/bin/python && $(cat "$venv/stamp" 2>/dev/null) == "$stamp" ]] && return
    echo "$command: installing $name into $venv (once)"
    rm -rf "$venv"
    log=$("$python" -m venv "$venv" 2>&1) || die "no environment in $venv:" \
        "$(tail -n 1 <<< "$log")"
    log=$("$venv/bin/python" -m pip install -q --disable-pip-version-check \
        -r "$requirements" 2>&1) || die "$name cannot be installed:" \
        "$(grep -i error <<< "$log" | tail -n 1)"
    log=$("$venv/bin/python" -c "$package" 2>&1) \
        || die "$name is installed in $venv and does not start: $(tail -n 1 <<< "$log")"
    echo "$stamp" > "$venv/stamp"
}

# ready: what scripts/setup builds, and its environment; cg2raw as it was built, studies,
# and the oracles of its tests.
ready()
{
    [[ -x $root/.venv/bin/python && -f $root/build/wheel/build.ninja ]] \
        || "$root/scripts/setup"
    source "$root/scripts/env"
    export PYTHONPATH="$root/build/system/lib/python:$root:$root/tests"
}
