#!/usr/bin/env bash
# A job for Slurm: sbatch scripts/slurm.sh CASE [what follows the case goes to taut run]
#   sbatch --nodes=16 scripts/slurm.sh cases/drape-large/case.yaml --out out/large
# If the folder holds a run already, the job goes on with it, so the same line, sent again, ends what ran out of time.
#
# Placement: one rank a core and no threads. Taut is bound by memory bandwidth, so ranks fill the sockets of a node evenly
# (block:cyclic deals nodes out in blocks, and the ranks of a node to its sockets in turn), each bound to its core; hyper-threads bring nothing.
# PETSc's BLAS and PT-Scotch would start threads of their own, which OMP_NUM_THREADS=1 and the program itself prevent. Neighbouring ranks
# have neighbouring parts only by chance, which matters little: a rank talks to some six others. Take at least some
# thousand vertices a rank: `taut partition CASE --ranks N` tells what a cut costs, scripts/scaling.py model what a step would take.
#
#SBATCH --job-name=taut
#SBATCH --nodes=1
#SBATCH --ntasks-per-node=32
#SBATCH --cpus-per-task=1
#SBATCH --hint=nomultithread
#SBATCH --distribution=block:cyclic
#SBATCH --time=04:00:00
#SBATCH --signal=USR1@120
#SBATCH --output=taut-%j.log
# USR1 reaches every rank two minutes before the end: a checkpoint is written, the exit code is 4.
set -euo pipefail

[ $# -gt 0 ] && [ "$1" != --help ] || {
  echo "usage: sbatch [--nodes=N] scripts/slurm.sh CASE --out FOLDER [options of taut run]
It needs sbatch and srun of Slurm, a folder that all nodes see, and build/taut in the folder where sbatch is called
or on the PATH (TAUT names another program, TAUT_LAUNCH what starts it in place of srun). A run that the folder holds
already goes on." >&2
  exit 2
}
# module load ...                      # what the site calls its MPI, PETSc and HDF5: those Taut was built with
taut=${TAUT:-${SLURM_SUBMIT_DIR:-.}/build/taut}
[ -x "$taut" ] || [ "${TAUT:-}" ] || taut=$(command -v taut || echo "$taut")
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 HDF5_USE_FILE_LOCKING=FALSE # locks fail on some parallel file systems
launch=(${TAUT_LAUNCH:-srun --cpu-bind=cores})

# The folder is where --out says, or out/<name of the case>.
out=
words=("$@")
for ((k = 0; k < $#; ++k)); do
  [ "${words[k]}" != --out ] || out=${words[k + 1]:-}
  [[ ${words[k]} != --out=* ]] || out=${words[k]#--out=}
done
[ -n "$out" ] || {
  echo "slurm.sh: give --out FOLDER, where the run goes and is found again" >&2
  exit 2
}
[ -x "$taut" ] || {
  echo "slurm.sh: $taut: no such program; build it with scripts/build, or name it in TAUT" >&2
  exit 2
}
command -v "${launch[0]}" > /dev/null || {
  echo "slurm.sh: ${launch[0]}: not found; this is a job for Slurm: sbatch scripts/slurm.sh ..." >&2
  exit 2
}
if [ -f "$out/case.yaml" ]; then
  echo "slurm.sh: $out holds a run, which goes on as its own case.yaml says; other settings: taut resume $out --set KEY=VALUE"
  exec "${launch[@]}" "$taut" resume "$out"
fi
exec "${launch[@]}" "$taut" run "$@"
