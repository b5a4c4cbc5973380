# Shared pieces of the scripts beside this file; sourced, never run.
# shellcheck shell=bash

# shellcheck disable=SC2034 # for the scripts that source this
{
    root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
    target=$(cd "$root" && realpath -m "${CARGO_TARGET_DIR:-target}")
    nagata=$target/release/nagata
    ruff_folder=$target/ruff
    [ -e "$root/Cargo.toml" ] || nagata=/usr/bin/nagata # the scripts of an installed package
    system=$(. /etc/os-release 2>/dev/null || ID=unknown; echo "$ID ${VERSION_ID:-}") # such as "debian 12"
}

say() {
    local script
    script=$(realpath -- "$0")
    echo "${script#"$root"/}: $*" >&2
}

# Prints the comment block under the first line of the calling script: its usage.
usage() { awk 'NR > 1 && !/^#/ { exit } NR > 1 { sub(/^# ?/, ""); print }' "$0"; }

# install_packages PACKAGE...: installs those that are missing; silent when none is.
install_packages() {
    if ! command -v dpkg-query >/dev/null; then
        say "this system has no apt. Install what corresponds to these packages of Debian 12: $*"
        exit 2
    fi
    local installed missing=() package as_root=() log
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
    for package; do
        grep -qxF "installed $package" <<<"$installed" || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0

    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            say "run as root: apt-get install --no-install-recommends ${missing[*]}"
            exit 2
        fi
        as_root=(sudo)
    fi
    as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -y -o DPkg::Lock::Timeout=300)
    say "installing ${missing[*]}"
    log=$(mktemp)
    if ! { "${as_root[@]}" update && "${as_root[@]}" install --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
        tail -n 20 "$log" >&2
        rm -f "$log"
        say "apt-get failed (above). The package names are those of Debian 12 and Ubuntu 24.04."
        exit 2
    fi
    rm -f "$log"
}

# Environment for Open MPI and the libraries under it; what the user has set stays.
mpi_environment() {
    if [ "$(id -u)" -eq 0 ]; then # mpirun refuses root otherwise
        export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    fi
    export OMPI_MCA_rmaps_base_oversubscribe=${OMPI_MCA_rmaps_base_oversubscribe:-1} # more ranks than cores is fine
    export OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}   # a rank is one core
    export SCOTCH_PTHREAD_NUMBER=${SCOTCH_PTHREAD_NUMBER:-1} # its ordering varies from run to run otherwise
    if [ -z "${SLURM_JOB_ID:-}${PBS_JOBID:-}" ]; then        # one machine: shared memory only, starts faster
        export OMPI_MCA_pml=${OMPI_MCA_pml:-ob1} OMPI_MCA_btl=${OMPI_MCA_btl:-self,vader}
    fi
}

# Rust installed by rustup but not yet on this shell's path.
command -v cargo >/dev/null || PATH=$PATH:$HOME/.cargo/bin
