// expect: undeclared|not declared
int main() {
#ifdef SKINCTL_RIGHT
  return 0;
#else
  return a1 + a2 + a3 + a4 + a5 + a6 + a7 + a8 + a9 + a10;
#endif
}
