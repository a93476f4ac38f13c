# shellcheck shell=bash
# Functions of tests that need a Debian 12 without any of Rehearse. Source it; `skip` ends with exit status 77.

skip() { echo "skipped: $*"; exit 77; }

# make_bare WORK: makes WORK/root, a bare Debian that reaches Debian's packages as this machine does. WORK/bare.tar is kept.
make_bare() {
  local work=$1 root=$1/root
  ((EUID == 0)) || skip "only root can make a bare Debian"
  command -v mmdebstrap > /dev/null || skip "mmdebstrap isn't installed"
  mkdir -p "$work"
  if [[ ! -f $work/bare.tar ]]; then
    mmdebstrap --variant=apt bookworm "$work/new.tar" > "$work/mmdebstrap.log" 2>&1 \
      || skip "mmdebstrap made no Debian (no network?): $(tail -n 1 "$work/mmdebstrap.log")"
    mv "$work/new.tar" "$work/bare.tar"
  fi
  rm -rf "$root"
  mkdir "$root"
  tar --extract --file "$work/bare.tar" --directory "$root" --exclude './dev/*'
  # the machine's own way to Debian's packages, and names of hosts
  cp -r /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/"
  cp /etc/resolv.conf "$root/etc/"
  mkdir -p "$root/dev" "$root/proc"
  mknod -m 666 "$root/dev/null" c 1 3
  mknod -m 666 "$root/dev/urandom" c 1 9
}

# run_in_bare ROOT SCRIPT: executes a script of the root in it, without this machine's environment.
run_in_bare() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root \
    unshare --mount --pid --fork --mount-proc="$1/proc" chroot "$1" bash -e "$2"
}

# begin_repository SOURCE PACKAGES: makes the folder $scratch with a key of gpg, "Test of Rehearse". make_repository then calls
# tools/repository for the packages. At the end of the test the folder is removed.
begin_repository() {
  scratch=$(mktemp -d) server=
  trap '[[ -z $server ]] || kill "$server"; rm -rf "$scratch"' EXIT
  # tools/repository reads build/packages of the folder that it is in
  mkdir -p "$scratch/source/build"
  cp -r "$1/tools" "$scratch/source/"
  ln -s "$2" "$scratch/source/build/packages"
  export GNUPGHOME=$scratch/keys
  mkdir --mode 700 "$GNUPGHOME"
  gpg --batch --quiet --passphrase '' --quick-generate-key "Test of Rehearse" ed25519 sign never 2> /dev/null
}
make_repository() { "$scratch/source/tools/repository" "$@"; }

# serve FOLDER FILE: serves a folder on the loopback address until the end of the test, and writes the port to a file.
serve() {
  python3 -m http.server --bind 127.0.0.1 --directory "$1" 0 > "$scratch/server" 2>&1 &
  server=$!
  for _ in {1..100}; do
    grep -oE 'port [0-9]+' "$scratch/server" | grep -oE '[0-9]+' > "$2" && break
    sleep 0.1
  done
}
