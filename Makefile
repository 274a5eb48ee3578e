# SPDX-License-Identifier: Apache-2.0
# fray: `make run` tears a sheet, `make test` runs every test, `make help` lists the rest.

CC ?= cc
BUILD ?= build
OPT ?= -O3
WARN := -Wall -Wextra -Wconversion -Wshadow -Wundef -Werror
FLAGS := -std=c11 $(OPT) -g -I. $(WARN) -MMD -MP $(EXTRA)
FUZZ_SECONDS ?= 60

RT_C := $(wildcard rt/*/*.c)
TOOL_C := $(wildcard tools/*.c tools/*/*.c platform/*.c platform/log/*.c platform/linux/*.c)
UNIT_C := $(wildcard tests/unit/*.c tests/oracle/*.c tests/sim/test_*.c)
HELPER_C := tests/cross/emit.c tests/target/tape.c tests/cli/alter.c tests/bus/bare_timer.c \
            tests/bus/flood_facts.c tests/work/limits_of.c tests/work/longest.c

RT_O := $(RT_C:%.c=$(BUILD)/%.o)
TOOL_O := $(TOOL_C:%.c=$(BUILD)/%.o)
TOOLS_LIB := $(BUILD)/libtools.a
RT_LIB := $(BUILD)/libfray.a
FRAY := $(BUILD)/fray
TESTS := $(UNIT_C:%.c=$(BUILD)/%)
HELPERS := $(HELPER_C:%.c=$(BUILD)/%)
SYS_TESTS := $(filter $(BUILD)/tests/sim/test_sys_%,$(TESTS))
SIM_TESTS := $(filter-out $(SYS_TESTS),$(filter $(BUILD)/tests/sim/%,$(TESTS)))
SIM_O := $(BUILD)/tests/sim/sim_board.o
FAULT_O := $(patsubst %,$(BUILD)/faults/platform/linux/%.o,board bus_log can_socket timer)
IMAGE_16 := $(BUILD)/id16/tests/unit/test_image
WIDE_16 := $(BUILD)/id16/tests/unit/test_wide
FX_NARROW := $(addprefix $(BUILD)/narrow/tests/unit/,test_fx test_sweep)

.PHONY: all help run test clean san san-gcc san-clang san-integer san-thread checked golden golden-update wide fuzz tidy size stack work budget-update \
        proof install bench figures force targets target-test can-test bus-test bus-test-qemu bus-soak
all: $(FRAY) ## build the `fray` command

help: ## list the targets
	@awk -F':.*## ' '/^[a-z-]+:.*## /{printf "  %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(RT_LIB): $(RT_O)
	@rm -f $@
	@$(AR) rcs $@ $^

$(TOOLS_LIB): $(filter-out $(BUILD)/tools/main.o,$(TOOL_O))
	@rm -f $@
	@$(AR) rcs $@ $^

$(FRAY): $(BUILD)/tools/main.o $(TOOLS_LIB) $(RT_LIB)
	@echo "  LD   $@"
	@$(CC) $(EXTRA) $^ -lm -pthread -o $@

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CC) $(FLAGS) -c $< -o $@

# what must not wrap unless it says so: the runtime, and what computes images
$(BUILD)/rt/%.o $(BUILD)/tools/build/%.o: FLAGS += $(EXACT)

# sanitizers make much of kernels that are one function each: minutes a file at -O2
$(BUILD)/rt/wide/%.o: FLAGS += $(WIDE)

# pictures are the same to the byte everywhere: no fused products, no x87, no floats in doubles
MACROS = $(shell echo __i386__ __s390__ | $(CC) $(EXTRA) -E -P -x c - 2>/dev/null)
FLOATS = $(if $(filter 1,$(word 1,$(MACROS))),-msse2 -mfpmath=sse) \
         $(if $(filter 1,$(word 2,$(MACROS))),-fexcess-precision=fast)
$(BUILD)/tools/render/%.o: FLAGS += -ffp-contract=off $(FLOATS)

$(TESTS) $(HELPERS): $(BUILD)/%: $(BUILD)/%.o $(TOOLS_LIB) $(RT_LIB)
	@$(CC) $(EXTRA) $(filter %.o,$^) $(filter %.a,$^) -lm -pthread -o $@

# the runtime's strain stage, and others in its place
FEWER := $(BUILD)/tests/fewer/fewer
-include $(FEWER).d $(BUILD)/tests/fewer/methods.d
$(FEWER): $(BUILD)/tests/fewer/fewer.o $(BUILD)/tests/fewer/methods.o $(TOOLS_LIB) $(RT_LIB)
	@$(CC) $(EXTRA) $^ -lm -pthread -o $@

# Boards of their own: the bus in memory for the loop, and a kernel in memory for the board on Linux.
$(SIM_TESTS): $(SIM_O)
$(SYS_TESTS): $(BUILD)/tests/sim/sys_faults.o $(FAULT_O)

$(BUILD)/faults/%.o: %.c
	@mkdir -p $(@D)
	@echo "  CC   $< (FRAY_SYS_FAULTS)"
	@$(CC) $(FLAGS) -DFRAY_SYS_FAULTS -c $< -o $@

# fixed point and sweeps once more, as on cores that do one thing at a time
$(FX_NARROW) &: force
	@$(MAKE) --no-print-directory -s BUILD=$(BUILD)/narrow EXTRA="$(EXTRA) -DFX_NARROW=1 -DFX_NO_LONG_MULTIPLY=1" EXACT="$(EXACT)" $(FX_NARROW)

# the loader and the wide kernels once more, with 16-bit ids
$(IMAGE_16) $(WIDE_16) &: force
	@$(MAKE) --no-print-directory -s BUILD=$(BUILD)/id16 EXTRA="$(EXTRA) -DFRAY_ID_BITS=16" EXACT="$(EXACT)" $(IMAGE_16) $(WIDE_16)

-include $(RT_O:.o=.d) $(TOOL_O:.o=.d) $(TESTS:=.d) $(HELPERS:=.d) $(FAULT_O:.o=.d) \
         $(SIM_O:.o=.d) $(BUILD)/tests/sim/sys_faults.d

run: $(FRAY) ## tear a sheet with two hands from a log of the bus; results in out/
	@mkdir -p out
	$(FRAY) scene tests/scenes/two_hands.scene -o out/two_hands.img
	$(FRAY) run out/two_hands.img --log tests/scenes/two_hands.log --record out/two_hands.log --report out
	$(FRAY) verify out/two_hands.log --scene out/two_hands.img

test: $(FRAY) $(TESTS) $(HELPERS) $(IMAGE_16) $(WIDE_16) $(FX_NARROW) ## run every test; SUITES="cli tidy" picks shell suites
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) SUITES="$(SUITES)" \
	  sh tests/run_all.sh $(TESTS) $(IMAGE_16) $(WIDE_16) $(FX_NARROW)

ROWS ?= 100000000
WIDE_TESTS := $(BUILD)/tests/unit/test_wide $(WIDE_16) $(addprefix $(BUILD)/tests/unit/,test_wide_sweeps test_wide_contacts test_wide_slides test_wide_sheets)
wide: $(WIDE_TESTS) ## wide kernels against the scalar code, ROWS (10^8) random rows of each kind
	@for program in $(WIDE_TESTS); do echo "$$program $(ROWS)"; ./$$program $(ROWS) || exit 1; done

SANITIZE := -fno-sanitize-recover=all -fno-omit-frame-pointer -DSWEEP_FEWER=10 -DTEAM_STACK=4194304
san: san-gcc san-clang san-integer ## every test program and the command, under sanitizers of gcc and clang

san-gcc:
	$(MAKE) test SUITES=cli BUILD=build-san-gcc CC=gcc OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-O0

# what clang makes of wide kernels runs for minutes: under it they take random rows, not scenes
san-clang:
	$(MAKE) wide ROWS=200000 BUILD=build-san-clang/wide CC=clang OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-O0
	$(MAKE) test SUITES=cli BUILD=build-san-clang CC=clang OPT=-O2 EXTRA="-fsanitize=address,undefined $(SANITIZE)" WIDE=-fno-sanitize=all

san-integer: ## rt and the scene compiler under clang's integer sanitizer: a wrap is meant or a bug
	$(MAKE) test SUITES=cli BUILD=build-san-integer CC=clang OPT=-O2 EXTRA="-fsanitize=undefined $(SANITIZE)" EXACT=-fsanitize=integer

san-thread: $(FRAY) ## the threads that share a tick, under clang's thread sanitizer
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/workers/workers.sh race

checked: ## every test program and the command, where a sum out of its range traps
	$(MAKE) test SUITES=cli BUILD=build-checked EXTRA=-DFRAY_CHECKED

golden: $(FRAY) $(HELPERS) ## hashes of every tick and images: every machine, compiler and option
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/cross/hashes.sh full

golden-update: $(FRAY) $(HELPERS) ## write tests/golden anew; commit it alone and say why
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/cross/hashes.sh update

fuzz: $(FRAY) ## feed the parsers and the loader with damaged input, FUZZ_SECONDS each
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/fuzz/fuzz.sh $(FUZZ_SECONDS)

bus-test: $(FRAY) $(BUILD)/tests/bus/bare_timer $(BUILD)/tests/bus/flood_facts ## live sessions on vcan, on the host or in a guest, with can-utils
	@FRAY=$(FRAY) BUILD=$(BUILD) sh tests/bus/run.sh

bus-soak: $(FRAY) $(BUILD)/tests/bus/bare_timer $(BUILD)/tests/bus/flood_facts ## bus-test with 200 kills, 30 s of lateness, a flood of 40 s
	@FRAY=$(FRAY) BUILD=$(BUILD) FRAY_BUS_SOAK=1 sh tests/bus/run.sh

bus-test-qemu: $(FRAY) $(BUILD)/tests/bus/bare_timer $(BUILD)/tests/bus/flood_facts ## the same bus on two emulated controllers, and on vcan with unpinned queues
	@FRAY=$(FRAY) BUILD=$(BUILD) sh tests/bus/run.sh qemu

targets: $(FRAY) $(HELPERS) ## firmwares of every bare-metal machine, and what they take of its memory
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/target/targets.sh build

target-test: $(FRAY) $(HELPERS) ## run them in QEMU at stated rates, and try their guards
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/target/targets.sh test

can-test: $(FRAY) $(HELPERS) ## the bare-metal CAN port in sessions on an emulated ZCU102
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/target/zcu102.sh

figures: $(FRAY) ## pictures of the scenes in tests/figures/list.txt; FIGURES="figure8" picks, SIZE=800x450
	@FRAY=$(FRAY) BUILD=$(BUILD) SIZE="$(SIZE)" sh tests/figures/figures.sh $(FIGURES)

.PHONY: weaves pools patches thesis
THESIS := $(addprefix $(BUILD)/tests/oracle/,test_ceiling test_garments test_press test_layers)
thesis: $(THESIS) ## scenes of Karaoz 2015 at full length, 1,000 bodies thrown at cloth (minutes)
	@for program in $(THESIS); do ./$$program all || exit 1; done

patches: $(BUILD)/tests/oracle/test_patch ## every patch of triangle sheets under load (minutes)
	@$< all

pools: $(BUILD)/tests/oracle/test_yarn_pools ## a tearing sheet with pools of every size (a minute)
	@$< all

weaves: $(FRAY) ## how plain and twill weave fray, 20 seeds each (minutes); SEEDS=5
	@FRAY=$(FRAY) BUILD=$(BUILD) SEEDS="$(SEEDS)" sh tests/figures/weaves.sh

proof: $(RT_LIB) ## warnings of every compiler, gcc's analyzer, MISRA, Frama-C Eva (minutes)
	@BUILD=$(BUILD) sh tests/proof/proof.sh

install: $(RT_LIB) ## library, headers, CMake config, fray.pc below PREFIX; DESTDIR is for packagers
	@sh platform/package/install.sh $(RT_LIB) $(or $(PREFIX),/usr/local) $(DESTDIR)

tidy: ## arrows between folders, sizes of files and functions, licences, cppcheck
	@BUILD=$(BUILD) sh tests/tidy.sh

size: $(FRAY) $(HELPERS) ## bytes of code by machine and folder, RAM by pool, against their budgets
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/cross/size.sh

stack: $(FRAY) $(HELPERS) ## the deepest stack by the call graph, beside a painted one
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/stack/stack.sh

budget-update: $(FRAY) $(HELPERS) ## write measured code, RAM and stack to tests/budget; say why
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/stack/stack.sh update
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/cross/size.sh update
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/work/work.sh update

work: $(FRAY) $(HELPERS) ## instructions per tick by stage on small targets, the bound of the worst tick
	@MAKE_COMMAND="$(MAKE)" FRAY=$(FRAY) BUILD=$(BUILD) sh tests/work/work.sh

bench: $(FRAY) ## times by stage beside float loops, for every scene: out/bench.md, out/bench.json (minutes)
	@FRAY=$(FRAY) sh tools/bench/bench.sh out

.PHONY: fewer
fewer: $(FEWER) ## strain against counted projections, for other ways to hold links; SCENE=two_hands picks (minutes)
	@$(FEWER) $(SCENE)

clean: ## remove what was built
	rm -rf $(BUILD) build-san-gcc build-san-clang build-san-integer build-checked out
