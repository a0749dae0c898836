#pragma once

/// Compiles a function twice, for any x86-64 and for processors with AVX2, and takes the one that fits at load time.
/// For loops over pixels that the compiler vectorises. Both give the same bytes: neither contracts to fused
/// multiply-add. Sanitizers cannot run the selection, which happens before they are set up.
#if defined(__x86_64__) && defined(__ELF__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(RIGPROOF_NO_VECTOR_CLONES)
#define RIGPROOF_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define RIGPROOF_VECTOR_CLONES
#endif
