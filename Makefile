# SPDX-License-Identifier: Apache-2.0
# fray: `make run` tears a sheet, `make test` runs every test, `make help` lists the rest.

CC ?= cc
BUILD ?= build
OPT ?= -O3
WARN := -Wall -Wextra -Wconversion -Wshadow -Wundef -Werror
FLAGS := -std=c11 $(OPT) -g -I. $(WARN) -MMD -MP $(EXTRA)

RT_C := $(wildcard rt/*/*.c)
TOOL_C := $(wildcard tools/*.c tools/*/*.c platform/log/*.c)
UNIT_C := $(wildcard tests/unit/*.c tests/oracle/*.c tests/run/*.c)

RT_O := $(RT_C:%.c=$(BUILD)/%.o)
TOOL_O := $(TOOL_C:%.c=$(BUILD)/%.o)
TOOLS_LIB := $(BUILD)/libtools.a
RT_LIB := $(BUILD)/libfray.a
FRAY := $(BUILD)/fray
TESTS := $(UNIT_C:%.c=$(BUILD)/%)

.PHONY: all help run test clean
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
	@$(CC) $(EXTRA) $^ -lm -o $@

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CC) $(FLAGS) -c $< -o $@

$(TESTS): $(BUILD)/%: $(BUILD)/%.o $(TOOLS_LIB) $(RT_LIB)
	@$(CC) $(EXTRA) $^ -lm -o $@

-include $(RT_O:.o=.d) $(TOOL_O:.o=.d) $(TESTS:=.d)

run: $(FRAY) ## tear a sheet with two hands from a log of the bus; results in out/
	@mkdir -p out
	$(FRAY) scene tests/scenes/two_hands.scene -o out/two_hands.img
	$(FRAY) run out/two_hands.img --log tests/scenes/two_hands.log --record out/two_hands.log --report out
	$(FRAY) verify out/two_hands.log --scene out/two_hands.img

test: $(FRAY) $(TESTS) ## run every test
	@FRAY=$(FRAY) BUILD=$(BUILD) sh tests/run_all.sh $(TESTS)

clean: ## remove what was built
	rm -rf $(BUILD) out
