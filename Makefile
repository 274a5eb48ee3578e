# SPDX-License-Identifier: Apache-2.0
# fray: `make run` tears a sheet, `make test` runs every test, `make help` lists the rest.

CC ?= cc
BUILD ?= build
OPT ?= -O3
# lines and functions, for backtraces; variables take a third of the time of compiling: OPT="-Og -g" has them
DEBUG ?= -g1
WARN := -Wall -Wextra -Wconversion -Wshadow -Wundef -Werror
FLAGS := -std=c11 $(DEBUG) $(OPT) -I. $(WARN) -MMD -MP $(EXTRA)
FUZZ_SECONDS ?= 60
FUZZ_RUNS ?= 0

RT_C := $(wildcard rt/*/*.c)
TOOL_C := $(wildcard tools/*.c tools/*/*.c platform/*.c platform/files/*.c platform/log/*.c platform/linux/*.c)
UNIT_C := $(wildcard tests/unit/*.c tests/physics/*.c tests/sim/test_*.c)
HELPER_C := tests/determinism/emit_cases.c tests/target/tape.c tests/cli/alter.c tests/bus/bare_timer.c \
            tests/bus/flood_facts.c tests/bus/log_until.c tests/wcet/print_loop_limits.c tests/wcet/longest_path.c tests/wild/wild.c

RT_O := $(RT_C:%.c=$(BUILD)/%.o)
TOOL_O := $(TOOL_C:%.c=$(BUILD)/%.o)
# half of the whole time of compiling: begun first, side by side
SLOW_O := $(filter %/avx512.o %/avx2.o,$(RT_O))
TOOLS_LIB := $(BUILD)/libtools.a
RT_LIB := $(BUILD)/libfray.a
FRAY := $(BUILD)/fray
TESTS := $(UNIT_C:%.c=$(BUILD)/%)
HELPERS := $(HELPER_C:%.c=$(BUILD)/%)
SYS_TESTS := $(filter $(BUILD)/tests/sim/test_sys_%,$(TESTS))
SIM_TESTS := $(filter-out $(SYS_TESTS),$(filter $(BUILD)/tests/sim/%,$(TESTS)))
SIM_O := $(BUILD)/tests/sim/sim_board.o
WILD_O := $(patsubst %.c,$(BUILD)/%.o,$(filter-out tests/wild/wild.c,$(wildcard tests/wild/*.c)))
FAULT_O := $(patsubst %,$(BUILD)/faults/platform/linux/%.o,board bus_log can_socket timer)
# rt built in another way, in the folder and as the golden table builds it (tests/determinism/configs.sh) if this is
# no build with options of its own
PLAIN := $(if $(EXTRA)$(filter-out cc gcc,$(CC)),,yes)
ID16 := $(BUILD)/$(if $(PLAIN),cross/gcc-,)id16
NARROW := $(BUILD)/$(if $(PLAIN),cross/gcc-,)narrow
VARIANT_OPT := $(if $(PLAIN),-O2,$(OPT))
IMAGE_16 := $(ID16)/tests/unit/test_image
WIDE_16 := $(ID16)/tests/unit/test_simd
ASSERTED := $(if $(EXTRA),,$(BUILD)/asserted/tests/unit/test_assertions)
FX_NARROW := $(addprefix $(NARROW)/tests/unit/,test_fx test_ccd)

.PHONY: all help run test clean san san-gcc san-clang san-integer san-wide san-thread checked analysis golden golden-update wide fuzz tidy lines size stack work budget-update \
        proof install bench compare options docs figures force targets target-test can-test bus-test bus-test-qemu bus-soak
all: command ## build the `fray` command

# What targets below need is compiled by a make of its own, JOBS files at a time unless this one was given a -j.
# Each of these targets has the one before, so that two goals never make one file at a time.
ifndef JOBS
JOBS := $(shell nproc 2>/dev/null || echo 2)
endif
export JOBS
SUBMAKE = @+$(MAKE) --no-print-directory $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(JOBS))
.PHONY: library command helpers programs
library: $(if $(filter-out library proof,$(MAKECMDGOALS)),command)
	$(SUBMAKE) $(RT_LIB)
command:
	$(SUBMAKE) $(FRAY)
helpers: command
	$(SUBMAKE) $(HELPERS)
programs: helpers
	$(SUBMAKE) $(TESTS) $(IMAGE_16) $(WIDE_16) $(FX_NARROW) $(ASSERTED)

# What is wide runs in parts: PART=2/8 is every eighth word of a list from the second on.
PART ?= 1/1
PARTS_proof := misra eva analyzer warnings
PARTS_san := san-gcc san-clang san-integer checked san-wide
PARTS_analysis := analyzer $(filter-out analyzer,$(PARTS_proof)) $(PARTS_san)
PARTS_guests := bed sessions keys qemu
PARTS_target-test := m0 m3 m4f m7f m33 m55 r5f rv32 microbit
share = $(or $(shell sh tests/part.sh share $(PART) $(PARTS_$(1))),$(error make $(1): no part $(PART)))
.PHONY: guests
parts-of-%: force
	@printf '%s\n' $(call share,$*)

# `[n/m] ` before what is compiled: m is what a dry run would compile, asked when the first file is. Only where
# all goals are files: no recipe of theirs runs a make.
ifdef COUNTING
PROGRESS := COUNTED
else ifneq ($(filter $(BUILD)/%,$(MAKECMDGOALS)),)
ifeq ($(filter-out $(BUILD)/%,$(MAKECMDGOALS)),)
COUNTED_GOALS := $(filter-out $(IMAGE_16) $(WIDE_16) $(FX_NARROW) $(ASSERTED),$(MAKECMDGOALS))
TOTAL = $(eval TOTAL := $(shell MAKEFLAGS= $(MAKE) -n COUNTING=1 BUILD=$(BUILD) $(COUNTED_GOALS) 2>/dev/null | grep -c COUNTED))$(TOTAL)
PROGRESS = $(eval DONE += x)[$(words $(DONE))/$(TOTAL)]
endif
endif

help: ## list the targets
	@awk -F':.*## ' '/^[a-z-]+:.*## /{printf "  %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(RT_LIB): $(RT_O)
	@rm -f $@
	@$(AR) rcs $@ $^

$(TOOLS_LIB): $(filter-out $(BUILD)/tools/main.o,$(TOOL_O))
	@rm -f $@
	@$(AR) rcs $@ $^

$(FRAY): $(SLOW_O) $(BUILD)/tools/main.o $(TOOLS_LIB) $(RT_LIB)
	@echo "  LD   $@"
	@$(CC) $(EXTRA) $(filter-out $(SLOW_O),$^) -lm -pthread -o $@

$(BUILD)/%.o: %.c
	$(info $(EMPTY)  CC   $(PROGRESS) $<)
	@$(if $(wildcard $(@D)/.),,mkdir -p $(@D))
	@$(CC) $(FLAGS) -c $< -o $@

# what must not wrap unless it says so: the runtime, and what computes images
$(BUILD)/rt/%.o $(BUILD)/tools/scene_language/%.o $(BUILD)/tools/mesh_import/%.o $(BUILD)/tools/scene_compiler/%.o: FLAGS += $(EXACT)

# sanitizers make much of kernels that are one function each: minutes a file at -O2
$(BUILD)/rt/simd/%.o: FLAGS += $(WIDE)

# pictures are the same to the byte everywhere: no fused products, no x87, no floats in doubles
MACROS = $(shell echo __i386__ __s390__ | $(CC) $(EXTRA) -E -P -x c - 2>/dev/null)
FLOATS = $(if $(filter 1,$(word 1,$(MACROS))),-msse2 -mfpmath=sse) \
         $(if $(filter 1,$(word 2,$(MACROS))),-fexcess-precision=fast)
$(BUILD)/tools/render/%.o: FLAGS += -ffp-contract=off $(FLOATS)

$(TESTS) $(HELPERS): $(BUILD)/%: $(BUILD)/%.o $(TOOLS_LIB) $(RT_LIB)
	@$(CC) $(EXTRA) $(filter %.o,$^) $(filter %.a,$^) -lm -pthread -o $@

# what one test alone uses
$(BUILD)/tests/unit/test_dictionary: $(BUILD)/tests/lib/dictionary_text.o

# Boards of their own: the bus in memory for the loop, and a kernel in memory for the board on Linux.
$(SIM_TESTS): $(SIM_O)
$(BUILD)/tests/wild/wild: $(WILD_O)
$(SYS_TESTS): $(BUILD)/tests/sim/sys_faults.o $(FAULT_O)

$(BUILD)/faults/%.o: %.c
	$(info $(EMPTY)  CC   $(PROGRESS) $< (FRAY_SYS_FAULTS))
	@$(if $(wildcard $(@D)/.),,mkdir -p $(@D))
	@$(CC) $(FLAGS) -DFRAY_SYS_FAULTS -c $< -o $@

# fixed point and sweeps once more, as on cores that do one thing at a time
$(FX_NARROW) &: force
	@$(MAKE) --no-print-directory -s BUILD=$(NARROW) OPT=$(VARIANT_OPT) EXTRA="$(EXTRA) -DFX_NARROW=1 -DFX_NO_LONG_MULTIPLY=1" EXACT="$(EXACT)" $(FX_NARROW)

# all of rt once more, with assertions that say where they are
$(BUILD)/asserted/tests/unit/test_assertions: force
	@$(MAKE) --no-print-directory -s BUILD=$(BUILD)/asserted OPT=-O0 EXTRA="-DFRAY_ASSERTIONS -include tests/lib/assertion_report.h" $@

# the loader and the wide kernels once more, with 16-bit ids
$(IMAGE_16) $(WIDE_16) &: force
	@$(MAKE) --no-print-directory -s BUILD=$(ID16) OPT=$(VARIANT_OPT) EXTRA="$(EXTRA) -DFRAY_ID_BITS=16" EXACT="$(EXACT)" $(IMAGE_16) $(WIDE_16)

-include $(RT_O:.o=.d) $(TOOL_O:.o=.d) $(TESTS:=.d) $(HELPERS:=.d) $(FAULT_O:.o=.d) \
         $(SIM_O:.o=.d) $(WILD_O:.o=.d) $(BUILD)/tests/sim/sys_faults.d $(BUILD)/tests/lib/dictionary_text.d

run: command ## tear a sheet with two hands from a log of the bus; results in out/
	@mkdir -p out
	$(FRAY) scene tests/scenes/two_hands_yarns.scene -o out/two_hands.img
	$(FRAY) run out/two_hands.img --log tests/scenes/two_hands_yarns.log --record out/two_hands.log --report out
	$(FRAY) verify out/two_hands.log --scene out/two_hands.img

test: programs ## run every test; SUITES="cli tidy" picks shell suites; PART=2/8 of its wide tables
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) SUITES="$(SUITES)" \
	  sh tests/run_all.sh $(TESTS) $(IMAGE_16) $(WIDE_16) $(FX_NARROW) $(ASSERTED)

ROWS ?= 100000000
WIDE_TESTS := $(BUILD)/tests/unit/test_simd $(WIDE_16) $(addprefix $(BUILD)/tests/unit/,test_simd_particle_loops test_simd_contacts test_simd_membrane)
wide: $(WIDE_TESTS) ## wide kernels against the scalar code, ROWS (10^8) random rows of each kind
	@for program in $(WIDE_TESTS); do echo "$$program $(ROWS)"; ./$$program $(ROWS) || exit 1; done

SANITIZE := -DFRAY_ASSERTIONS -fno-sanitize-recover=all -fno-omit-frame-pointer -DTEST_FEWER=10 -DWORKERS_STACK=4194304
san: ## every test program and the command, under sanitizers of gcc and clang, and where sums trap; PART=2/5
	@for goal in $(call share,san); do $(MAKE) --no-print-directory PART=1/1 $$goal || exit 1; done

# wide kernels under a sanitizer are slow, or compile for minutes: there they take random rows, and in the programs run bare
san-wide:
	$(MAKE) wide ROWS=200000 BUILD=build-san-gcc/wide CC=gcc OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-O0
	$(MAKE) wide ROWS=200000 BUILD=build-san-clang/wide CC=clang OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-O0

san-gcc:
	$(MAKE) test SUITES=cli BUILD=build-san-gcc CC=gcc OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-fno-sanitize=all

san-clang:
	$(MAKE) test SUITES=cli BUILD=build-san-clang CC=clang OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-fno-sanitize=all

san-integer: ## rt and the scene compiler under clang's integer sanitizer: a wrap is meant or a bug
	$(MAKE) test SUITES=cli BUILD=build-san-integer CC=clang OPT=-O2 EXTRA="-fsanitize=undefined $(SANITIZE)" EXACT=-fsanitize=integer

san-thread: command ## the threads that share a tick, under clang's thread sanitizer
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/workers/workers.sh race

checked: ## every test program and the command, where a sum out of its range traps
	$(MAKE) test SUITES=cli BUILD=build-checked EXTRA=-DFRAY_CHECKED

golden: helpers ## hashes of every tick and images: every machine, compiler and option; PART=2/8
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) PART=$(PART) sh tests/determinism/hashes.sh full

golden-update: helpers ## write tests/golden anew; commit it alone and say why
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/determinism/hashes.sh update

fuzz: command ## feed the parsers and the loader with damaged input, FUZZ_SECONDS or FUZZ_RUNS executions each; TARGETS="image obj" picks
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/fuzz/fuzz.sh $(FUZZ_SECONDS) $(FUZZ_RUNS) $(TARGETS)

bus-test: helpers ## live sessions on vcan, on the host or in a guest, with can-utils
	@FRAY=$(FRAY) BUILD=$(BUILD) sh tests/bus/run.sh

bus-soak: helpers ## bus-test with 200 kills, 30 s of lateness, a flood of 40 s
	@FRAY=$(FRAY) BUILD=$(BUILD) FRAY_BUS_SOAK=1 sh tests/bus/run.sh

bus-test-qemu: helpers ## the same bus on two emulated controllers, and on vcan with unpinned queues
	@FRAY=$(FRAY) BUILD=$(BUILD) sh tests/bus/run.sh qemu

targets: helpers ## firmwares of every bare-metal machine, and what they take of its memory
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/target/targets.sh build

target-test: helpers ## run them in QEMU at stated rates, and try their guards; PART=2/8
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) MACHINES="$(call share,target-test)" sh tests/target/targets.sh test

guests: helpers ## the bus in its guests: the bed, sessions, sessions under a key, emulated controllers; PART=2/4
	@code=0; for guest in $(call share,guests); do FRAY=$(FRAY) BUILD=$(BUILD) sh tests/bus/run.sh $$guest || code=1; done; exit $$code

can-test: helpers ## the bare-metal CAN port in sessions on an emulated ZCU102
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/target/zcu102.sh

figures: command ## pictures of the scenes in tests/figures/list.txt; FIGURES="figure8" picks, SIZE=800x450
	@FRAY=$(FRAY) BUILD=$(BUILD) SIZE="$(SIZE)" UPDATE="$(UPDATE)" sh tests/figures/figures.sh $(FIGURES)

.PHONY: busy
GOALS ?= test can-test target-test bus-test bus-test-qemu
busy: ## GOALS beside 20 processes that never rest, TIMES in a row: nothing may depend on how busy the machine is
	@MAKEFLAGS= MAKE_COMMAND="$(MAKE)" BUILD=$(BUILD) TIMES=$(or $(TIMES),1) sh tests/busy.sh BUILD=$(BUILD) $(GOALS)

.PHONY: wild
wild: $(BUILD)/tests/wild/wild ## COUNT (100) random scenes of SEED (1) from FIRST (0) on, judged by ledger, depth, speed and hashes; SECONDS=2
	@$< $(or $(SEED),1) $(or $(COUNT),100) $(or $(SECONDS),2) $(or $(FIRST),0)

.PHONY: weaves pools patches thesis
THESIS := $(addprefix $(BUILD)/tests/physics/,test_ceiling test_garments test_contact_triangles test_triangle_collision)
thesis: $(THESIS) ## scenes of Karaoz 2015 at full length, 1,000 bodies thrown at cloth (minutes)
	@for program in $(THESIS); do ./$$program all || exit 1; done

.PHONY: motion
MOTION := $(addprefix $(BUILD)/tests/physics/,test_calm_contact test_cantilever)
motion: $(MOTION) ## cloth that comes to rest at every rate, cantilevers of every mesh (minutes)
	@for program in $(MOTION); do ./$$program all || exit 1; done

patches: $(BUILD)/tests/physics/test_patch ## every patch of membranes under load (minutes)
	@$< all

pools: $(BUILD)/tests/physics/test_yarn_pools ## a tearing sheet with pools of every size (a minute)
	@$< all

weaves: command ## how plain weave, twill and satin fray, 20 seeds each (minutes); SEEDS=5
	@FRAY=$(FRAY) BUILD=$(BUILD) SEEDS="$(SEEDS)" UPDATE="$(UPDATE)" sh tests/figures/weaves.sh

proof: library ## MISRA, Frama-C Eva, gcc's analyzer, warnings of every compiler (minutes); PART=2/4
	@BUILD=$(BUILD) PROOFS="$(call share,proof)" sh tests/proof/proof.sh

.PHONY: misra eva analyzer warnings
misra eva analyzer warnings: library
	@BUILD=$(BUILD) PROOFS=$@ sh tests/proof/proof.sh

analysis: ## proofs and sanitizers, one after the other; PART=2/8
	@for goal in $(call share,analysis); do $(MAKE) --no-print-directory PART=1/1 $$goal || exit 1; done

# The shared library: objects of its own, since those of the archive are not for any address; of its names only those
# that public headers declare. Its file's name has the version when it is installed.
SHARED := $(BUILD)/libfray.so
PIC_LIB := $(BUILD)/pic/libfray.a
$(PIC_LIB): force
	@$(MAKE) --no-print-directory -s BUILD=$(BUILD)/pic EXTRA="$(EXTRA) -fPIC" $@
$(SHARED): $(PIC_LIB) platform/package/install.sh
	@sh platform/package/install.sh exports $< >$(BUILD)/pic/exports
	@$(CC) $(EXTRA) -shared -Wl,-z,defs -Wl,-soname,libfray.so.$(shell sh platform/package/install.sh series) \
	  -Wl,--version-script=$(BUILD)/pic/exports -Wl,--whole-archive $< -Wl,--no-whole-archive -o $@

.PHONY: uninstall
# by variables of the recipe's shell, which make fills: no character of theirs is the shell's
INSTALLED = $(BUILD) "$${PREFIX:-/usr/local}" "$$DESTDIR"
install: command ## command, man page, completion, library, headers, CMake config, fray.pc below PREFIX; DESTDIR is for packagers
	$(SUBMAKE) $(SHARED)
	@sh platform/package/install.sh install $(INSTALLED)

uninstall: ## remove what `make install` with the same PREFIX and DESTDIR puts there
	@sh platform/package/install.sh uninstall $(INSTALLED)

tidy: ## arrows between rooms, names, words, sizes, contracts, licences; RULES="arrows stems" picks
	@BUILD=$(BUILD) RULES="$(RULES)" sh tests/tidy/tidy.sh

.PHONY: cppcheck
cppcheck: ## cppcheck finds nothing in rt (a minute or two; seconds where little has changed); PART=2/8
	@BUILD=$(BUILD) PART=$(PART) sh tests/proof/cppcheck.sh

lines: ## lines of code, assertions and comments of rt, platform, tools, tests, functions that assert; ROOT=DIR of another tree
	@sh tests/lines.sh $(ROOT)
	@sh tests/assertions.sh $(ROOT)

size: helpers ## bytes of code by machine and folder, RAM by pool, against their budgets
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/budget/size.sh

stack: helpers ## the deepest stack by the call graph, beside a painted one
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/stack/stack.sh

budget-update: helpers ## write measured code, RAM and stack to tests/budget; say why
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/stack/stack.sh update
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/budget/size.sh update
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/wcet/wcet.sh update

work: helpers ## instructions per tick by stage on small targets, the bound of the worst tick
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/wcet/wcet.sh

options: command ## bytes of code of rt by build option, of a world by width of ids, into tests/results.tsv (minutes)
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/budget/options.sh update

docs: $(FRAY) $(RT_LIB) ## hold the pages: links, names, blocks, figures
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/docs/docs.sh

bench: command ## times by stage beside float loops, for every scene: out/bench.md, out/bench.json (minutes); UPDATE=update writes tests/results.tsv
	@FRAY=$(FRAY) sh tools/bench/bench.sh out $(UPDATE)

compare: ## this commit beside BASE=REVISION: `make run` from nothing, times of a tick; SCENES="flag small" picks (minutes)
	@MAKEFLAGS= BUILD=$(BUILD) sh tools/bench/compare.sh $(BASE) $(SCENES)

clean: ## remove what was built
	rm -rf $(BUILD) build-san-gcc build-san-clang build-san-integer build-checked out
