// What reelay's headers mention of CUDD. Only its data monitors call it; the Boolean discrete monitor,
// which is measured here, never does, so that nothing of this is ever run.
#pragma once

#include <cstdlib>
#include <stdexcept>
#include <vector>

struct DdNode {};

struct BDD {
  BDD() = default;
  [[noreturn]] static BDD none() { std::abort(); }
  BDD operator~() const { none(); }
  BDD operator!() const { none(); }
  BDD operator*(const BDD &) const { none(); }
  BDD operator+(const BDD &) const { none(); }
  BDD operator-(const BDD &) const { none(); }
  BDD operator&(const BDD &) const { none(); }
  BDD operator|(const BDD &) const { none(); }
  BDD &operator*=(const BDD &) { std::abort(); }
  BDD &operator+=(const BDD &) { std::abort(); }
  BDD &operator-=(const BDD &) { std::abort(); }
  BDD &operator&=(const BDD &) { std::abort(); }
  BDD &operator|=(const BDD &) { std::abort(); }
  bool operator==(const BDD &) const { std::abort(); }
  bool operator!=(const BDD &) const { std::abort(); }
  bool operator<=(const BDD &) const { std::abort(); }
  bool IsZero() const { std::abort(); }
  bool IsOne() const { std::abort(); }
  BDD ExistAbstract(const BDD &) const { none(); }
  BDD UnivAbstract(const BDD &) const { none(); }
  BDD PickOneMinterm(const std::vector<BDD> &) const { none(); }
  DdNode *getNode() const { std::abort(); }
};

struct Cudd {
  Cudd(unsigned = 0, unsigned = 0) {}
  void AutodynDisable() const {}
  BDD bddOne() const { return BDD(); }
  BDD bddZero() const { return BDD(); }
  BDD bddVar() const { return BDD(); }
  BDD computeCube(const std::vector<BDD> &) const { return BDD(); }
};
