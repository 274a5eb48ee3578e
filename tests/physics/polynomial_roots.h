/* SPDX-License-Identifier: Apache-2.0 */
/* Polynomials with integer coefficients, their roots in [0, 1], and the sign of one at a root of
 * another, all exact: roots are isolated by Descartes' rule on halves of the interval. */
#ifndef FRAY_TESTS_PHYSICS_POLYNOMIAL_ROOTS_H
#define FRAY_TESTS_PHYSICS_POLYNOMIAL_ROOTS_H

#include "tests/physics/big_integer.h"

enum { POLY_MAX = 5, ROOTS_MAX = 6 };

typedef struct {
  int degree; /* -1: zero */
  big c[POLY_MAX];
} poly;

static inline void poly_trim(poly *p) {
  while (p->degree >= 0 && p->c[p->degree].sign == 0) --p->degree;
}
static inline void poly_copy(poly *to, const poly *from) {
  to->degree = from->degree;
  for (int n = 0; n <= from->degree; ++n) big_copy(&to->c[n], &from->c[n]);
}
/* from + t (to - from) */
static inline void poly_line(poly *p, int64_t from, int64_t to) {
  big_set(&p->c[0], from);
  big_set(&p->c[1], to - from);
  p->degree = 1;
  poly_trim(p);
}
static inline void poly_sum(poly *to, const poly *a, const poly *b, int negative) {
  static big zero;
  const int most = a->degree > b->degree ? a->degree : b->degree;
  for (int n = 0; n <= most; ++n) {
    const big *x = n <= a->degree ? &a->c[n] : &zero;
    const big *y = n <= b->degree ? &b->c[n] : &zero;
    if (negative)
      big_subtract(&to->c[n], x, y);
    else
      big_add(&to->c[n], x, y);
  }
  to->degree = most;
  poly_trim(to);
}
/* `to` is neither a nor b. */
static inline void poly_multiply(poly *to, const poly *a, const poly *b) {
  static big product;
  to->degree = a->degree < 0 || b->degree < 0 ? -1 : a->degree + b->degree;
  for (int n = 0; n <= to->degree; ++n) big_set(&to->c[n], 0);
  for (int n = 0; n <= a->degree && b->degree >= 0; ++n)
    for (int k = 0; k <= b->degree; ++k) {
      big_multiply(&product, &a->c[n], &b->c[k]);
      big_add(&to->c[n + k], &to->c[n + k], &product);
    }
}
static inline void poly_derive(poly *to, const poly *p) {
  static big n_big;
  to->degree = p->degree < 1 ? -1 : p->degree - 1;
  for (int n = 1; n <= p->degree; ++n) {
    big_set(&n_big, n);
    big_multiply(&to->c[n - 1], &p->c[n], &n_big);
  }
}
/* Divides by what all coefficients have in common. */
static inline void poly_reduce(poly *p) {
  static big common;
  big_set(&common, 0);
  for (int n = 0; n <= p->degree; ++n) big_divisor(&common, &common, &p->c[n]);
  if (common.sign == 0 || big_bits(&common) == 1) return;
  for (int n = 0; n <= p->degree; ++n) big_divide(&p->c[n], &common);
}

/* p modulo q, times a power of q's leading coefficient; the quotient, so scaled, where asked. */
static inline void poly_remainder(poly *p, const poly *q, poly *quotient) {
  static big scaled, taken;
  if (quotient != NULL) {
    quotient->degree = p->degree - q->degree;
    for (int n = 0; n <= quotient->degree; ++n) big_set(&quotient->c[n], 0);
  }
  while (p->degree >= q->degree) {
    const int shift = p->degree - q->degree;
    static big lead;
    big_copy(&lead, &p->c[p->degree]);
    if (quotient != NULL) {
      for (int n = 0; n <= quotient->degree; ++n) {
        big_multiply(&scaled, &quotient->c[n], &q->c[q->degree]);
        big_copy(&quotient->c[n], &scaled);
      }
      big_add(&quotient->c[shift], &quotient->c[shift], &lead);
    }
    for (int n = 0; n <= p->degree; ++n) {
      big_multiply(&scaled, &p->c[n], &q->c[q->degree]);
      big_copy(&p->c[n], &scaled);
      if (n < shift) continue;
      big_multiply(&taken, &lead, &q->c[n - shift]);
      big_subtract(&p->c[n], &p->c[n], &taken);
    }
    poly_trim(p);
  }
}
static inline void poly_divisor(poly *to, const poly *a, const poly *b) {
  poly x, y;
  poly_copy(&x, a);
  poly_copy(&y, b);
  while (y.degree >= 0) {
    poly_remainder(&x, &y, NULL);
    poly_reduce(&x);
    poly_copy(to, &x);
    poly_copy(&x, &y);
    poly_copy(&y, to);
  }
  poly_copy(to, &x);
}
/* With each root once. */
static inline void poly_square_free(poly *p) {
  poly slope, common, quotient;
  poly_derive(&slope, p);
  poly_divisor(&common, p, &slope);
  if (common.degree < 1) return;
  poly_remainder(p, &common, &quotient);
  poly_copy(p, &quotient);
  poly_reduce(p);
}

/* p(x + 1) */
static inline void poly_shift(poly *p) {
  for (int from = 0; from < p->degree; ++from)
    for (int n = p->degree - 1; n >= from; --n) big_add(&p->c[n], &p->c[n], &p->c[n + 1]);
}
/* 2^d p(x / 2), so that (0, 1) is the left half; poly_shift() makes it the right one. */
static inline void poly_left(poly *p) {
  for (int n = 0; n < p->degree; ++n) big_shift_left(&p->c[n], (uint32_t)(p->degree - n));
}
static inline int poly_sign_half(const poly *p) {
  static big sum, part;
  big_set(&sum, 0);
  for (int n = 0; n <= p->degree; ++n) {
    big_copy(&part, &p->c[n]);
    big_shift_left(&part, (uint32_t)(p->degree - n));
    big_add(&sum, &sum, &part);
  }
  return sum.sign;
}
static inline int poly_sign_one(const poly *p) {
  static big sum;
  big_set(&sum, 0);
  for (int n = 0; n <= p->degree; ++n) big_add(&sum, &sum, &p->c[n]);
  return sum.sign;
}
static inline int poly_sign_zero(const poly *p) { return p->degree < 0 ? 0 : p->c[0].sign; }

/* Changes of sign of (1 + x)^d p(1 / (1 + x)): as many roots in (0, 1), or an even number fewer. */
static inline int poly_variations(const poly *p) {
  poly turned;
  int changes = 0;
  int last = 0;
  turned.degree = p->degree;
  for (int n = 0; n <= p->degree; ++n) big_copy(&turned.c[n], &p->c[p->degree - n]);
  for (int from = 0; from < p->degree; ++from)
    for (int n = p->degree - 1; n >= from; --n)
      big_add(&turned.c[n], &turned.c[n], &turned.c[n + 1]);
  for (int n = 0; n <= p->degree; ++n) {
    const int sign = turned.c[n].sign;
    if (sign != 0 && last != 0 && sign != last) ++changes;
    if (sign != 0) last = sign;
  }
  return changes;
}

/* A root of p as a way of halvings of (0, 1), left or right; where `exact`, the middle of what is
 * left is the root, else it is the only root in there. Where `end` is not -1: the number 0 or 1. */
enum { HALVINGS_MAX = 1024 };
typedef struct {
  int end, exact;
  uint32_t length;
  uint8_t right[HALVINGS_MAX];
  poly p;
} root;

static inline void follow_path(poly *p, const root *r) {
  for (uint32_t n = 0; n < r->length; ++n) {
    poly_left(p);
    if (r->right[n]) poly_shift(p);
  }
}

typedef struct {
  uint32_t count;
  root at[ROOTS_MAX];
  root path;
  const poly *whole;
} roots;

/* Returns 0 where `depth` does not part the roots. */
static inline int isolate_roots(roots *all, const poly *p, uint32_t depth) {
  const int changes = poly_variations(p);
  if (changes == 0) return 1;
  const int at_half = poly_sign_half(p) == 0;
  if (changes == 1 || at_half) {
    root *r = &all->at[all->count++];
    *r = all->path;
    r->exact = at_half;
    poly_copy(&r->p, all->whole);
    if (changes == 1) return 1;
  }
  if (all->path.length == depth) return 0;
  poly half;
  poly_copy(&half, p);
  poly_left(&half);
  all->path.right[all->path.length++] = 0;
  if (!isolate_roots(all, &half, depth)) return 0;
  poly_shift(&half);
  all->path.right[all->path.length - 1u] = 1;
  if (!isolate_roots(all, &half, depth)) return 0;
  --all->path.length;
  return 1;
}
/* The roots of p in (0, 1); p is made simple where that is needed. */
static inline void roots_of(roots *all, poly *p) {
  for (int simple = 0; simple < 2; ++simple) {
    all->count = 0;
    all->path.length = 0;
    all->path.end = -1;
    all->whole = p;
    if (p->degree < 1 || isolate_roots(all, p, simple ? HALVINGS_MAX : 24u)) return;
    poly_square_free(p);
  }
  printf("algebraic: roots do not part\n");
  exit(1);
}

/* The sign of q at the root. */
static inline int sign_at(const poly *q, const root *at) {
  if (q->degree < 1) return poly_sign_zero(q);
  if (at->end >= 0) return at->end == 0 ? poly_sign_zero(q) : poly_sign_one(q);
  poly here, p, left, common;
  poly_copy(&here, q);
  follow_path(&here, at);
  if (at->exact) return poly_sign_half(&here);
  poly_copy(&p, &at->p);
  follow_path(&p, at);
  for (uint32_t step = 0; step < HALVINGS_MAX; ++step) {
    if (step == 12) {
      poly_divisor(&common, &at->p, q);
      if (common.degree > 0) {
        poly_square_free(&common);
        follow_path(&common, at);
        if (poly_variations(&common) % 2 != 0) return 0;
      }
    }
    if (poly_variations(&here) == 0) return poly_sign_half(&here);
    if (poly_sign_half(&p) == 0) return poly_sign_half(&here);
    poly_copy(&left, &p);
    poly_left(&left);
    poly_left(&here);
    const int in_left = poly_variations(&left) % 2 != 0;
    poly_copy(&p, &left);
    if (in_left) continue;
    poly_shift(&p);
    poly_shift(&here);
  }
  printf("algebraic: a sign is not found\n");
  exit(1);
}

#endif
