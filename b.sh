cd /tmp/scan6; cmake -S . -B build-own >/dev/null; nice -n -5 make -C build-own -j2 batten_internal 2>&1 | grep -E "error:|warning"
gcc -O2 -Iinclude -Isrc /tmp/scan-drive.c build-own/libbatten_internal.a -o /tmp/scan-drive $(pkg-config --libs cairo jansson lapacke openblas qhull_r expat) -lcholmod -lumfpack -fopenmp -lm
