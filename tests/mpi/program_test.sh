#!/usr/bin/env bash
# The program controlspace-mpi: program_test.sh MPIRUN CONTROLSPACE_MPI CONTROLSPACE
set -euo pipefail
read -ra mpirun <<<"$1"
ranked=$2 serial=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() {
    echo "failed: $*" >&2
    exit 1
}
on() { # RANKS ARGUMENT...
    local ranks=$1
    shift
    "${mpirun[@]}" -n "$ranks" "$ranked" "$@"
}

awk 'BEGIN {
    print "x,y,z,h"
    for (i = 0; i < 900; ++i) {
        z = (i + 0.5) / 450 - 1; r = sqrt(1 - z * z)
        print r * cos(2.4 * i) "," r * sin(2.4 * i) "," z "," 0.1 + 0.05 * z
    }
}' >sources.csv
printf 'x,y,z\n0.1,0.2,0.3\n-0.9,0.8,0\n3,0,0\n' >places.csv

for setting in "--structures K_oL --target-delta 0" "--structures K_oL --within 1.2" "--structures K_oV" \
    "--structures K_oV --target-delta 0" "--structures K_oLB --target-delta 0" "--structures K_oLB --within 1.2"; do
    # shellcheck disable=SC2086
    "$serial" query sources.csv places.csv -o expected.csv $setting 2>/dev/null
    # shellcheck disable=SC2086
    for ranks in 1 3; do
        on $ranks sample sources.csv places.csv -o found.csv $setting
        cmp -s found.csv expected.csv || fail "$setting on $ranks ranks: other metrics"
    done
    # In pieces, which the serial program reads.
    # shellcheck disable=SC2086
    on 3 export sources.csv -o field.pctrl $setting
    "$serial" query field.pctrl places.csv -o found.csv
    cmp -s found.csv expected.csv || fail "$setting in pieces: other metrics"
done

# The checksum of results.
cat >study.toml <<'END'
sources = "sources.csv"
structures = "K_oL"
target_delta = 0.2
END
"$serial" compare study.toml -o results --quiet >/dev/null 2>&1 || fail "compare"
expected=$(grep -o '"checksum": *"[0-9a-f]*"' results/results.json | head -n 1 | grep -o '[0-9a-f]\{16\}')
[ "$(on 2 checksum study.toml)" = "checksum: $expected" ] || fail "another checksum than that of results"

"$serial" info field.pctrl | grep -q "in pieces" || fail "info of pieces"
"$serial" export field.pctrl -o field.vdb --quiet 2>/dev/null && [ -s field.vdb ] || fail "pieces as .vdb"
on 3 export sources.csv -o field.pvtu
for rank in 0 1 2; do
    [ -s field_$rank.ctrl ] && [ -s field_$rank.vtu ] || fail "no piece of rank $rank"
    grep -q "field_$rank.vtu" field.pvtu || fail "field.pvtu without rank $rank"
done

# One message, no hang.
expect_failure() { # PATTERN RANKS ARGUMENT...
    local pattern=$1 status=0
    shift
    on "$@" >out 2>err || status=$?
    [ $status -ne 0 ] || fail "succeeded: $*"
    [ "$(grep -c 'error:' err)" = 1 ] || fail "not one message: $(cat err)"
    grep -q -- "$pattern" err || fail "no '$pattern' in $(cat err)"
}
expect_failure "no such file\|No such file\|cannot" 3 build none.csv
expect_failure "folder" 3 build sources.csv -o no/folder/report.json
expect_failure "folder" 3 export sources.csv -o no/folder/field.pctrl
expect_failure "pctrl" 2 export sources.csv -o field.vtu
sed '$ s/,[^,]*$/,-1/' sources.csv >bad.csv
expect_failure "bad.csv:" 3 build bad.csv
expect_failure "K_oLi depends" 2 build sources.csv --structures K_oLi --target-delta 0.2
expect_failure "field" 2 build sources.csv --sources ball:0,0,0,r=0.1,h=0.1
printf 'x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n0,0,0,1,2,3,0,0,0\n1,1,1,1,2,3,0,0,0\n' >tensors.csv
expect_failure "max-leaves" 2 build sources.csv --within 1.2 --max-leaves 100
expect_failure "in-turn" 2 build tensors.csv --structures K_oL --target-delta 0 --intersection in-turn
# More ranks than sources, and the field of tensors by default.
for setting in "--structures K_oL --target-delta 0" ""; do
    # shellcheck disable=SC2086
    on 3 sample tensors.csv places.csv -o found.csv $setting 2>err || fail "tensors $setting: $(cat err)"
    grep -q "^tensors: .*tolerance" err || fail "no word on the tolerance: $(cat err)"
    [ "$(wc -l <found.csv)" = 4 ] || fail "tensors $setting: $(cat found.csv)"
done
[ ! -e no ] || fail "something was written"
echo "all as expected"
