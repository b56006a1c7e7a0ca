#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the Debian packages twice, installs them into a bare Debian 12 and runs their contents
# there.
#   run.sh BUILD WORK CHAIN
# CHAIN is a folder of `elastocal demo`. Ends with 77, which ctest reports as skipped, if no Debian
# can be made.
set -euo pipefail
build="$1" work="$2" chain="$3"

skip() {
  echo "Skipped: $1"
  exit 77
}
((EUID == 0)) || skip "only root can make a Debian to install into."
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed (scripts/setup --dev)."
unshare --mount true 2>/dev/null || skip "mounts are not allowed here."
sources=(/etc/apt/sources.list.d/debian.sources)
[[ -e "${sources[0]}" ]] || sources=(/etc/apt/sources.list)

rm -rf "$work"
mkdir -p "$work/given"
pack() {
  cpack --config "$build/CPackConfig.cmake" -B "$work/$1" >"$work/$1.log" 2>&1 || { cat "$work/$1.log"; return 1; }
}
pack first &
sleep 1.5  # so that all that depends on the time of day differs
pack second
wait $!
for package in "$work"/first/*.deb; do
  cmp "$package" "$work/second/${package##*/}" || { echo "the same files gave other bytes"; exit 1; }
done
mv "$work"/first/*.deb "$work/given"
rm -f "$work"/given/elastocal-mpi_*.deb  # MPI would bring a hundred packages

cat >"$work/given/inside" <<'INSIDE'
set -e
cd /media
apt-get -qq --download-only --no-install-recommends install ./*.deb >/dev/null || exit 75
dpkg -l gcc cmake 2>/dev/null | grep ^ii && { echo "this Debian is not bare"; exit 1; }
apt-get -qq --no-install-recommends install ./*.deb >/dev/null
elastocal --version
for file in /usr/share/man/man1/elastocal.1.gz /usr/share/bash-completion/completions/elastocal \
  /usr/share/doc/elastocal/notices.txt /usr/share/doc/libelastocal0/copyright; do
  dpkg -S "$file"
  test -s "$file"
done
cd /tmp
python3 -c "import elastocal; print(elastocal.Project('/usr/share/elastocal/models/talos/project.yaml').robot.name)"
elastocal calibrate /usr/share/elastocal/models/talos/project.yaml \
  --recording /mnt/recording /mnt/recording_sine /mnt/recording_random \
  --marker-places /mnt/recording/marker_places.csv -o out --quiet 2>/dev/null
diff <(grep -v ^recording: out/calibration.yaml) <(grep -v ^recording: /mnt/calibration.yaml)
echo "The calibration has the bits of the build's."
grep -q 'urdf-loader .*Apache-2.0' out/report.html
INSIDE

cat >"$work/hook" <<HOOK
touch '$work/root_is_there'
cp /etc/apt/apt.conf.d/* "\$1/etc/apt/apt.conf.d/"
mount --bind '$work/given' "\$1/media"
mount --bind '$chain' "\$1/mnt"
chroot "\$1" env DEBIAN_FRONTEND=noninteractive bash /media/inside || { echo \$? >'$work/status'; exit 1; }
HOOK

# The hook runs in the finished root, which has mounts of its own. Failures before it come from the
# network, not from the packages.
status=0
timeout 450 mmdebstrap --quiet --variant=minbase --mode=root --skip=cleanup --dpkgopt=force-unsafe-io \
  --customize-hook="unshare --mount bash -e '$work/hook' \"\$1\"" \
  bookworm /dev/null "${sources[@]}" 2>"$work/mmdebstrap.log" || status=$?
cat "$work/mmdebstrap.log"
((status == 0)) && exit 0
((status != 124)) || skip "the mirror took too long."
[[ -e "$work/root_is_there" ]] || skip "no Debian can be made here: $(tail -n 1 "$work/mmdebstrap.log")"
[[ "$(cat "$work/status" 2>/dev/null)" != 75 ]] || skip "Debian's packages cannot be downloaded."
exit 1
