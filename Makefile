# The short way to everything. CMake does the work; what is here only calls it.
#
#   make            build the library, the program and the tests       (build/release)
#   make demo       turn real input into pictures and a table          (out)
#   make test       build and run the tests
#   make smallest   build and test the parts that need the C library alone  (build/smallest)
#   make python     a wheel and a source distribution of the Python package, tested    (dist)
#   make docs       a site of all pages, tutorials, a gallery, both references     (build/site)
#   make bench      build and run the benchmarks
#   make sanitize   the tests under AddressSanitizer and UndefinedBehaviorSanitizer, without those of the verbs, the papers'
#                   tables and studies, gradients in double precision and, unless SLOW= is given, trainings
#   make sanitize-clang   the program's verbs under Clang's sanitizers, which know of more
#   make sanitize-threads  the library's tests with four threads under Clang's ThreadSanitizer
#   make coverage   the lines of src that the tests run, by folder
#   make fuzz       every fuzzer for FUZZ_SECONDS
#   make web        the page out/web/index.html and the npm package in web/npm
#   make web-test   their tests, and unit tests of the library as 32-bit code under Node
#   make style      check the format and run clang-tidy; `make format` formats
#   make install    the library and the program to PREFIX, below DESTDIR
#   make install-research  the library batten-research beside them
#   make uninstall  remove what the last installations of this build put below DESTDIR
#   make clean      remove what was built
#
# GIS=no leaves GDAL out of what is installed.

JOBS ?= $(shell nproc 2>/dev/null || echo 2)
PREFIX ?= /usr/local
FUZZ_SECONDS ?= 60
# Forks, scripts, and what takes more than its time there.
NOT_FOR_THREADS = ^(fork|documents|interface|claims|scan_verdict)$$|^(package|program|mpi|web|kills)
OUT ?= out

configure = { cmake --preset $(1) >build/$(1).log 2>&1 || { cat build/$(1).log; exit 1; }; }
# The make that CMake starts is its own, with its own number of jobs.
compile = env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL cmake --build build/$(1) --parallel $(JOBS)
test = ctest --test-dir build/$(1) --output-on-failure --parallel $(JOBS)

.PHONY: all demo test smallest python docs bench sanitize sanitize-clang sanitize-threads coverage fuzz web-packages web web-test style format install install-research uninstall clean dependencies ci-dependencies

all: dependencies
	@$(call configure,release) && $(call compile,release)

demo: all
	@scripts/demo build/release/batten $(OUT)

test: all
	@$(call test,release)

smallest: dependencies
	@$(call configure,smallest) && $(call compile,smallest)
	@$(call test,smallest)

python: dependencies
	@scripts/python-wheel dist

docs: dependencies
	@$(call configure,release) && $(call compile,release) --target batten_shared batten_research_shared batten
	@scripts/docs build/release build/site

bench: all
	@for program in build/release/bench/bench_*; do if [ -x $$program ]; then $$program || exit 1; fi; done
	@web/test/run speed build/release/batten || [ $$? -eq 77 ]

SLOW = |_train$$|^scan_verdict$$
sanitize: dependencies
	@$(call configure,sanitize) && $(call compile,sanitize)
	@$(call test,sanitize) --exclude-regex '^program_|_table$$|_double$$|_study$$|_ablation$$|^documents$$|^mesh_shapes$$$(SLOW)'

sanitize-clang: ci-dependencies
	@$(call configure,sanitize-clang) && $(call compile,sanitize-clang) --target batten
	@$(call test,sanitize-clang) --tests-regex '^program_'

# Archer tells ThreadSanitizer what OpenMP's barriers order.
sanitize-threads: ci-dependencies
	@$(call configure,sanitize-threads) && $(call compile,sanitize-threads)
	@OMP_NUM_THREADS=4 OMP_TOOL_LIBRARIES="$$(echo /usr/lib/llvm-*/lib/libarcher.so)" \
	    TSAN_OPTIONS="ignore_noninstrumented_modules=1 exitcode=66" \
	    $(call test,sanitize-threads) --exclude-regex '$(NOT_FOR_THREADS)'

coverage: dependencies
	@$(call configure,coverage) && $(call compile,coverage)
	@find build/coverage -name '*.gcda' -delete
	@$(call test,coverage) --exclude-regex '^package_' || true
	@scripts/coverage build/coverage --kinds

fuzz: ci-dependencies
	@$(call configure,fuzz) && $(call compile,fuzz) --target fuzzers
	@scripts/run-fuzzers build/fuzz $(FUZZ_SECONDS) $(JOBS)

# Debian's emscripten finds its JavaScript modules by NODE_PATH.
web-packages web web-test: export NODE_PATH := $(or $(NODE_PATH),/usr/share/nodejs)

# What comes from Debian and npm; the only part that needs a network.
web-packages:
	@scripts/install-deps web
	@mkdir -p build
	@web/libraries
	@[ -d web/node_modules ] || npm ci --prefix web --ignore-scripts --no-progress

web: web-packages
	@$(call configure,web) && $(call compile,web) --target batten_engine
	@cp build/web/web/batten.wasm build/web-libraries/NOTICES LICENSE web/npm/
	@node web/npm/types.mjs
	@node web/page/build.mjs build/web/web out/web/index.html

web-test: web all
	@web/test/run engine build/release/batten
	@web/test/run fuzz build/release/batten
	@web/test/run bundles build/release/batten
	@web/test/run page build/release/batten
	@web/test/run firefox build/release/batten || [ $$? -eq 77 ]
	@$(call compile,web) --target web_tests
	@$(call test,web) -L unit

style: ci-dependencies
	@$(call configure,clang)
	@scripts/check-style build/clang $(JOBS)

format: ci-dependencies
	@scripts/list-sources | xargs clang-format -i

# An existing build is not rebuilt here, so that root need not build.
install: COMPONENT =
install-research: COMPONENT = --component research
install install-research:
	@test -x build/release/batten || $(MAKE) --no-print-directory all
	@DESTDIR='$(DESTDIR)' cmake --install build/release --prefix '$(PREFIX)' $(COMPONENT)
	@[ -n '$(DESTDIR)' ] || [ "$$(id -u)" -ne 0 ] || ldconfig

# CMake lists what it installs. Folders of the project's own go when they are empty.
uninstall:
	@awk 1 build/release/install_manifest*.txt >build/installed 2>/dev/null || \
	    { echo "nothing was installed from here" >&2; exit 1; }
	@while read -r file; do rm -f "$(DESTDIR)$$file"; done <build/installed
	@sed -n 's|/[^/]*$$||; /batten/p' build/installed | sort -ru | while read -r folder; do \
	    rmdir "$(DESTDIR)$$folder" 2>/dev/null || true; done
	@rm -f build/installed build/release/install_manifest*.txt
	@[ -n '$(DESTDIR)' ] || [ "$$(id -u)" -ne 0 ] || ldconfig

clean:
	@rm -rf build out dist

dependencies:
	@scripts/install-deps $(if $(filter no,$(GIS)),--without-gis)
	@mkdir -p build

ci-dependencies:
	@scripts/install-deps ci
	@mkdir -p build
