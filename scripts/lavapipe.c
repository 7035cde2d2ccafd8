/* A Vulkan driver for tests: lavapipe, Mesa's software Vulkan, which this library loads, with a faster compiler.
 *
 * lavapipe makes an LLVM coroutine of every compute kernel, so that threads of a workgroup can wait for each other at a barrier. LLVM
 * needs more time to split a coroutine than for everything else together, for two reasons:
 *
 * - It computes a dominator tree of the function for each local variable, so the time grows with the square of the size. A kernel without
 *   a barrier never waits, so this library makes a plain function of it.
 * - It visits the blocks in order of their addresses, again and again until nothing changes. This takes thousands of rounds when the
 *   addresses do not follow the flow of control. So this library moves the blocks of other kernels to addresses in that order, and it
 *   puts their variables into a few arrays.
 *
 * lavapipe calls LLVMRunPasses before it compiles a kernel. It finds the function of this name here, because this library makes its names
 * global before it loads lavapipe. Kernels stay as they are if LLVM lacks a function that is needed here.
 * scripts/software-vulkan builds this file. LAVAPIPE is the path of Mesa's driver.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef void *Ref; /* a module, function, block, instruction, type, builder or error of LLVM-C */

/* The functions of LLVM-C that are used: result, name, parameters. */
#define FUNCTIONS(X)                                                                                                             \
    X(Ref, LLVMRunPasses, (Ref, const char *, Ref, Ref))                                                                         \
    X(Ref, LLVMGetFirstFunction, (Ref))                                                                                          \
    X(Ref, LLVMGetNextFunction, (Ref))                                                                                           \
    X(Ref, LLVMGetFirstBasicBlock, (Ref))                                                                                        \
    X(Ref, LLVMGetNextBasicBlock, (Ref))                                                                                         \
    X(unsigned, LLVMCountBasicBlocks, (Ref))                                                                                     \
    X(Ref, LLVMGetBasicBlockTerminator, (Ref))                                                                                   \
    X(unsigned, LLVMGetNumSuccessors, (Ref))                                                                                     \
    X(Ref, LLVMGetSuccessor, (Ref, unsigned))                                                                                    \
    X(Ref, LLVMBasicBlockAsValue, (Ref))                                                                                         \
    X(void, LLVMMoveBasicBlockAfter, (Ref, Ref))                                                                                 \
    X(void, LLVMDeleteBasicBlock, (Ref))                                                                                         \
    X(void, LLVMInstructionRemoveFromParent, (Ref))                                                                              \
    X(void, LLVMInsertIntoBuilder, (Ref, Ref))                                                                                   \
    X(Ref, LLVMIsAAllocaInst, (Ref))                                                                                             \
    X(Ref, LLVMIsAConstantInt, (Ref))                                                                                            \
    X(Ref, LLVMGetAllocatedType, (Ref))                                                                                          \
    X(unsigned, LLVMGetAlignment, (Ref))                                                                                         \
    X(void, LLVMSetAlignment, (Ref, unsigned))                                                                                   \
    X(Ref, LLVMGetFirstUse, (Ref))                                                                                               \
    X(Ref, LLVMGetUser, (Ref))                                                                                                   \
    X(void, LLVMSetOperand, (Ref, unsigned, Ref))                                                                                \
    X(Ref, LLVMArrayType, (Ref, unsigned))                                                                                       \
    X(Ref, LLVMBuildAlloca, (Ref, Ref, const char *))                                                                            \
    X(Ref, LLVMGetFirstInstruction, (Ref))                                                                                       \
    X(Ref, LLVMGetNextInstruction, (Ref))                                                                                        \
    X(Ref, LLVMIsACallInst, (Ref))                                                                                               \
    X(Ref, LLVMGetCalledValue, (Ref))                                                                                            \
    X(const char *, LLVMGetValueName2, (Ref, size_t *))                                                                          \
    X(Ref, LLVMGetOperand, (Ref, unsigned))                                                                                      \
    X(void, LLVMReplaceAllUsesWith, (Ref, Ref))                                                                                  \
    X(void, LLVMInstructionEraseFromParent, (Ref))                                                                               \
    X(unsigned, LLVMGetEnumAttributeKindForName, (const char *, size_t))                                                         \
    X(Ref, LLVMGetEnumAttributeAtIndex, (Ref, unsigned, unsigned))                                                               \
    X(void, LLVMRemoveEnumAttributeAtIndex, (Ref, unsigned, unsigned))                                                           \
    X(Ref, LLVMGetModuleContext, (Ref))                                                                                          \
    X(Ref, LLVMConstInt, (Ref, unsigned long long, int))                                                                         \
    X(Ref, LLVMConstNull, (Ref))                                                                                                 \
    X(Ref, LLVMPointerType, (Ref, unsigned))                                                                                     \
    X(Ref, LLVMVoidTypeInContext, (Ref))                                                                                         \
    X(Ref, LLVMInt8TypeInContext, (Ref))                                                                                         \
    X(Ref, LLVMInt32TypeInContext, (Ref))                                                                                        \
    X(Ref, LLVMFunctionType, (Ref, Ref *, unsigned, int))                                                                        \
    X(Ref, LLVMAddFunction, (Ref, const char *, Ref))                                                                            \
    X(void, LLVMSetFunctionCallConv, (Ref, unsigned))                                                                            \
    X(void, LLVMSetLinkage, (Ref, int))                                                                                          \
    X(Ref, LLVMAppendBasicBlockInContext, (Ref, Ref, const char *))                                                              \
    X(Ref, LLVMCreateBuilderInContext, (Ref))                                                                                    \
    X(void, LLVMDisposeBuilder, (Ref))                                                                                           \
    X(void, LLVMPositionBuilderAtEnd, (Ref, Ref))                                                                                \
    X(void, LLVMPositionBuilderBefore, (Ref, Ref))                                                                               \
    X(Ref, LLVMBuildBitCast, (Ref, Ref, Ref, const char *))                                                                      \
    X(Ref, LLVMBuildGEP2, (Ref, Ref, Ref, Ref *, unsigned, const char *))                                                        \
    X(Ref, LLVMBuildStore, (Ref, Ref, Ref))                                                                                      \
    X(Ref, LLVMBuildRetVoid, (Ref))

static struct {
#define FIELD(result, name, parameters) result(*name) parameters;
    FUNCTIONS(FIELD)
} llvm;

/* Values of LLVM-C's enumerations, and LLVM's number of the calling convention of coroutines. */
enum { OF_FUNCTION = -1, INTERNAL_LINKAGE = 8, FAST_CALL = 8 };

/* Whether all of them were found. */
static bool has_llvm = true;

/* Mesa's driver. */
static void *lavapipe;

/* Loads lavapipe and finds the functions of LLVM, on which it depends. */
__attribute__((constructor)) static void load(void) {
    Dl_info own;
    if (!dladdr(&lavapipe, &own) || !dlopen(own.dli_fname, RTLD_NOW | RTLD_NOLOAD | RTLD_GLOBAL)) return;
    lavapipe = dlopen(LAVAPIPE, RTLD_NOW | RTLD_LOCAL);
    if (!lavapipe) return;
#define FIND(result, name, parameters) has_llvm &= (*(void **)&llvm.name = dlsym(lavapipe, #name)) != NULL;
    FUNCTIONS(FIND)
}

/* The three functions of a driver that the Vulkan loader calls. */
typedef void (*Function)(void);

Function vk_icdGetInstanceProcAddr(void *instance, const char *name) {
    Function (*next)(void *, const char *) = lavapipe ? dlsym(lavapipe, "vk_icdGetInstanceProcAddr") : NULL;
    return next ? next(instance, name) : NULL;
}

Function vk_icdGetPhysicalDeviceProcAddr(void *instance, const char *name) {
    Function (*next)(void *, const char *) = lavapipe ? dlsym(lavapipe, "vk_icdGetPhysicalDeviceProcAddr") : NULL;
    return next ? next(instance, name) : NULL;
}

int vk_icdNegotiateLoaderICDInterfaceVersion(unsigned *version) {
    enum { FAILED = -3 }; /* VK_ERROR_INITIALIZATION_FAILED */
    int (*next)(unsigned *) = lavapipe ? dlsym(lavapipe, "vk_icdNegotiateLoaderICDInterfaceVersion") : NULL;
    return next ? next(version) : FAILED;
}

/* The name of the function that an instruction calls, or "". */
static const char *called(Ref instruction) {
    size_t length;
    Ref function = llvm.LLVMIsACallInst(instruction) ? llvm.LLVMGetCalledValue(instruction) : NULL;
    return function ? llvm.LLVMGetValueName2(function, &length) : "";
}

/* Whether a coroutine has one suspension point, and all else is as make_plain expects it. */
static bool is_plain(Ref coroutine) {
    static const char *const expected[] = {"id", "size.i32", "begin", "suspend", "end"};
    enum { KINDS = sizeof expected / sizeof *expected };
    static const char prefix[] = "llvm.coro.";
    unsigned counts[KINDS + 1] = {0};
    for (Ref block = llvm.LLVMGetFirstBasicBlock(coroutine); block; block = llvm.LLVMGetNextBasicBlock(block)) {
        for (Ref i = llvm.LLVMGetFirstInstruction(block); i; i = llvm.LLVMGetNextInstruction(i)) {
            const char *name = called(i);
            if (strncmp(name, prefix, strlen(prefix)) != 0) continue;
            unsigned kind = 0;
            while (kind < KINDS && strcmp(name + strlen(prefix), expected[kind]) != 0) kind++;
            counts[kind]++;
        }
    }
    for (unsigned kind = 0; kind < KINDS; kind++)
        if (counts[kind] != 1) return false;
    return counts[KINDS] == 0;
}

/* Adds a function that destroys a frame, with nothing to do. */
static Ref add_destroy(Ref module, Ref builder) {
    Ref context = llvm.LLVMGetModuleContext(module), frame = llvm.LLVMPointerType(llvm.LLVMInt8TypeInContext(context), 0);
    Ref function = llvm.LLVMAddFunction(
        module, "destroy_nothing", llvm.LLVMFunctionType(llvm.LLVMVoidTypeInContext(context), &frame, 1, false));
    llvm.LLVMSetFunctionCallConv(function, FAST_CALL);
    llvm.LLVMSetLinkage(function, INTERNAL_LINKAGE);
    llvm.LLVMPositionBuilderAtEnd(builder, llvm.LLVMAppendBasicBlockInContext(context, function, "entry"));
    llvm.LLVMBuildRetVoid(builder);
    return function;
}

/* Makes a plain function of a coroutine that has no suspension point but the final one. Its frame keeps what callers look at: no function
 * to resume it, which means that it is done, and a function to destroy it. */
static void make_plain(Ref module, Ref coroutine, unsigned attribute) {
    Ref context = llvm.LLVMGetModuleContext(module), builder = llvm.LLVMCreateBuilderInContext(context);
    Ref byte = llvm.LLVMInt8TypeInContext(context), word = llvm.LLVMInt32TypeInContext(context);
    Ref pointer = llvm.LLVMPointerType(byte, 0), one = llvm.LLVMConstInt(word, 1, false);
    Ref destroy = add_destroy(module, builder);
    Ref replaced = NULL;
    for (Ref block = llvm.LLVMGetFirstBasicBlock(coroutine); block; block = llvm.LLVMGetNextBasicBlock(block)) {
        for (Ref i = llvm.LLVMGetFirstInstruction(block), next; i; i = next) {
            next = llvm.LLVMGetNextInstruction(i);
            const char *name = called(i);
            if (strcmp(name, "llvm.coro.id") == 0) {
                /* `llvm.coro.begin` uses it, which comes later. */
                replaced = i;
            } else if (strcmp(name, "llvm.coro.size.i32") == 0) {
                llvm.LLVMReplaceAllUsesWith(i, llvm.LLVMConstInt(word, 2 * sizeof(void *), false));
                llvm.LLVMInstructionEraseFromParent(i);
            } else if (strcmp(name, "llvm.coro.begin") == 0) {
                Ref frame = llvm.LLVMGetOperand(i, 1);
                llvm.LLVMPositionBuilderBefore(builder, i);
                Ref resume_at = llvm.LLVMBuildBitCast(builder, frame, llvm.LLVMPointerType(pointer, 0), "");
                llvm.LLVMBuildStore(builder, llvm.LLVMConstNull(pointer), resume_at);
                Ref destroy_at = llvm.LLVMBuildGEP2(builder, pointer, resume_at, &one, 1, "");
                llvm.LLVMBuildStore(builder, llvm.LLVMBuildBitCast(builder, destroy, pointer, ""), destroy_at);
                llvm.LLVMReplaceAllUsesWith(i, frame);
                llvm.LLVMInstructionEraseFromParent(i);
            } else if (strcmp(name, "llvm.coro.suspend") == 0) {
                /* Suspended, for which the caller of the coroutine waits. */
                llvm.LLVMReplaceAllUsesWith(i, llvm.LLVMConstInt(byte, 255, false));
                llvm.LLVMInstructionEraseFromParent(i);
            } else if (strcmp(name, "llvm.coro.end") == 0) {
                llvm.LLVMInstructionEraseFromParent(i);
            }
        }
    }
    llvm.LLVMInstructionEraseFromParent(replaced);
    llvm.LLVMRemoveEnumAttributeAtIndex(coroutine, (unsigned)OF_FUNCTION, attribute);
    llvm.LLVMDisposeBuilder(builder);
}

/* Whether an instruction makes room for a variable whose size is known. */
static bool is_variable(Ref instruction) {
    return llvm.LLVMIsAAllocaInst(instruction) && llvm.LLVMIsAConstantInt(llvm.LLVMGetOperand(instruction, 0));
}

/* Puts the local variables of a function that have the same type into one array. The variables are at the start of the function. */
static void merge_variables(Ref module, Ref function) {
    Ref context = llvm.LLVMGetModuleContext(module), word = llvm.LLVMInt32TypeInContext(context);
    Ref builder = llvm.LLVMCreateBuilderInContext(context), entry = llvm.LLVMGetFirstBasicBlock(function);
    Ref first = llvm.LLVMGetFirstInstruction(entry);
    while (first && is_variable(first)) {
        Ref type = llvm.LLVMGetAllocatedType(first);
        unsigned count = 0, place = 0;
        for (Ref i = first; is_variable(i); i = llvm.LLVMGetNextInstruction(i)) count += llvm.LLVMGetAllocatedType(i) == type;
        llvm.LLVMPositionBuilderBefore(builder, llvm.LLVMGetFirstInstruction(entry));
        Ref array_type = llvm.LLVMArrayType(type, count), array = llvm.LLVMBuildAlloca(builder, array_type, "");
        llvm.LLVMSetAlignment(array, llvm.LLVMGetAlignment(first));
        for (Ref i = first, next; is_variable(i); i = next) {
            next = llvm.LLVMGetNextInstruction(i);
            if (llvm.LLVMGetAllocatedType(i) != type) continue;
            Ref index[] = {llvm.LLVMConstInt(word, 0, false), llvm.LLVMConstInt(word, place++, false)};
            for (Ref use; (use = llvm.LLVMGetFirstUse(i));) {
                /* Beside the use, so that no pointer is kept across a suspension point. */
                Ref user = llvm.LLVMGetUser(use);
                unsigned operand = 0;
                while (llvm.LLVMGetOperand(user, operand) != i) operand++;
                llvm.LLVMPositionBuilderBefore(builder, user);
                llvm.LLVMSetOperand(user, operand, llvm.LLVMBuildGEP2(builder, array_type, array, index, 2, ""));
            }
            if (i == first) first = next;
            llvm.LLVMInstructionEraseFromParent(i);
        }
    }
    llvm.LLVMDisposeBuilder(builder);
}

/* A block, for a walk along the flow of control. */
struct Visit {
    Ref block;
    bool seen;
    unsigned successors; /* of them are visited */
};

static int compare_blocks(const void *one, const void *other) {
    uintptr_t a = *(const uintptr_t *)one, b = *(const uintptr_t *)other;
    return (a > b) - (a < b);
}

/* Writes the blocks of a function to `order`, each behind those from which it is reached, but for loops (reverse postorder). Returns
 * whether all blocks are reached. */
static bool follow(Ref function, struct Visit *visits, struct Visit **stack, Ref *order, unsigned count) {
    unsigned depth = 0, left = count;
    struct Visit *next = visits;
    for (Ref block = llvm.LLVMGetFirstBasicBlock(function); block; block = llvm.LLVMGetNextBasicBlock(block))
        *next++ = (struct Visit){.block = block};
    qsort(visits, count, sizeof *visits, compare_blocks);
    Ref to = llvm.LLVMGetFirstBasicBlock(function);
    while (true) {
        struct Visit *visit = to ? bsearch(&to, visits, count, sizeof *visits, compare_blocks) : NULL;
        if (visit && !visit->seen) {
            visit->seen = true;
            stack[depth++] = visit;
        }
        if (depth == 0) return left == 0;
        struct Visit *top = stack[depth - 1];
        Ref end = llvm.LLVMGetBasicBlockTerminator(top->block);
        unsigned successors = llvm.LLVMGetNumSuccessors(end);
        to = NULL;
        if (top->successors < successors) {
            to = llvm.LLVMGetSuccessor(end, successors - ++top->successors);
        } else {
            order[--left] = top->block;
            depth--;
        }
    }
}

/* Replaces the blocks of a function by new ones, whose addresses follow the flow of control. */
static void put_in_order(Ref module, Ref function) {
    unsigned count = llvm.LLVMCountBasicBlocks(function);
    struct Visit *visits = calloc(count, sizeof *visits), **stack = calloc(count, sizeof *stack);
    Ref *order = calloc(count, sizeof *order), *fresh = calloc(count, sizeof *fresh);
    if (visits && stack && order && fresh && follow(function, visits, stack, order, count)) {
        Ref context = llvm.LLVMGetModuleContext(module), builder = llvm.LLVMCreateBuilderInContext(context);
        for (unsigned i = 0; i < count; i++) fresh[i] = llvm.LLVMAppendBasicBlockInContext(context, function, "");
        qsort(fresh, count, sizeof *fresh, compare_blocks);
        for (unsigned i = 0; i < count; i++) {
            if (i > 0) llvm.LLVMMoveBasicBlockAfter(fresh[i], fresh[i - 1]);
            llvm.LLVMPositionBuilderAtEnd(builder, fresh[i]);
            for (Ref moved; (moved = llvm.LLVMGetFirstInstruction(order[i]));) {
                llvm.LLVMInstructionRemoveFromParent(moved);
                llvm.LLVMInsertIntoBuilder(builder, moved);
            }
        }
        for (unsigned i = 0; i < count; i++)
            llvm.LLVMReplaceAllUsesWith(llvm.LLVMBasicBlockAsValue(order[i]), llvm.LLVMBasicBlockAsValue(fresh[i]));
        for (unsigned i = 0; i < count; i++) llvm.LLVMDeleteBasicBlock(order[i]);
        llvm.LLVMDisposeBuilder(builder);
    }
    free(visits);
    free(stack);
    free(order);
    free(fresh);
}

/* Takes the place of LLVM's function. The passes that split coroutines are in the pipeline "default<O0>". */
Ref LLVMRunPasses(Ref module, const char *passes, Ref machine, Ref options) {
    static const char name[] = "presplitcoroutine";
    unsigned attribute = has_llvm ? llvm.LLVMGetEnumAttributeKindForName(name, strlen(name)) : 0;
    if (attribute && strncmp(passes, "default<O0>", 11) == 0) {
        for (Ref f = llvm.LLVMGetFirstFunction(module); f; f = llvm.LLVMGetNextFunction(f)) {
            if (!llvm.LLVMGetEnumAttributeAtIndex(f, (unsigned)OF_FUNCTION, attribute)) continue;
            if (is_plain(f)) make_plain(module, f, attribute);
            else {
                merge_variables(module, f);
                put_in_order(module, f);
            }
        }
    }
    return llvm.LLVMRunPasses(module, passes, machine, options);
}
