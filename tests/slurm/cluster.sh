#!/usr/bin/env bash
# A Slurm of two nodes on this machine: cluster.sh start|stop DIR. Needs root
# and Debian's slurm-wlm and munge. With SLURM_CONF=DIR/slurm.conf the usual
# commands talk to it; there is no accounting.
set -euo pipefail
verb=${1:?start or stop} dir=${2:?a folder}
host=$(hostname -s)

background() {  # NAME COMMAND...
  local name=$1
  shift
  "$@" >"$dir/log/$name.txt" 2>&1 </dev/null &
  echo $! >"$dir/run/$name.pid"
}

# Without munge that is already running.
start_munge() {
  install -d -o munge -g munge -m 755 /run/munge
  ! munge -n >/dev/null 2>&1 || return 0
  head -c 1024 /dev/urandom >"$dir/munge/key"
  chmod 400 "$dir/munge/key"
  chmod 700 "$dir/munge"
  chown -R munge:munge "$dir/munge"
  setpriv --reuid=munge --regid=munge --clear-groups munged \
    --key-file="$dir/munge/key" --log-file="$dir/munge/log" \
    --pid-file="$dir/munge/pid" --seed-file="$dir/munge/seed"
  for _ in {1..50}; do ! munge -n >/dev/null 2>&1 || return 0; sleep 0.1; done
}

write_configuration() {
  cat >"$dir/slurm.conf" <<CONF
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool/%n
SlurmctldPidFile=$dir/run/ctld
SlurmdPidFile=$dir/run/d-%n
SlurmctldPort=$port
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=1
MpiDefault=none
KillWait=2
SchedulerParameters=sched_interval=2,batch_sched_delay=0
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=2 RealMemory=1000
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=2 RealMemory=1000
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
}

case $verb in
  start)
    mkdir -p "$dir"/{state,spool,log,run,munge}
    dir=$(cd "$dir" && pwd -P)
    chmod 711 "$dir"
    port=$((20000 + $$ % 10000 * 3))
    start_munge
    write_configuration
    export SLURM_CONF=$dir/slurm.conf
    background slurmctld slurmctld -f "$SLURM_CONF" -D
    background n1 slurmd -f "$SLURM_CONF" -N n1 -D
    background n2 slurmd -f "$SLURM_CONF" -N n2 -D
    for _ in {1..100}; do
      [[ $(sinfo -h -N -o %T 2>/dev/null) != $'idle\nidle' ]] || exit 0
      sleep 0.2
    done
    echo "the nodes do not come up; see $dir/log" >&2
    exit 1
    ;;
  stop)
    for pid in "$dir"/run/{n1,n2,slurmctld}.pid "$dir/munge/pid"; do
      [[ ! -s $pid ]] || kill "$(<"$pid")" 2>/dev/null || true
    done
    ;;
esac
