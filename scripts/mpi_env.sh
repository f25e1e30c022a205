# shellcheck shell=bash
# Sourced by the other scripts: lets Open MPI run as root and on few cores, as in a container.
if [ "$(id -u)" -eq 0 ]; then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
# Copies between processes by ptrace are refused in many containers.
export OMPI_MCA_btl_vader_single_copy_mechanism="${OMPI_MCA_btl_vader_single_copy_mechanism:-none}"

# Physical cores that this process may use.
cores() {
    local allowed physical
    allowed=$(nproc)
    physical=$(lscpu -p=CORE,SOCKET 2>/dev/null | grep -v '^#' | sort -u | wc -l) || physical=0
    if [ "$physical" -gt 0 ] && [ "$physical" -lt "$allowed" ]; then
        echo "$physical"
    else
        echo "$allowed"
    fi
}
