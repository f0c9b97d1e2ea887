// expect: missing.*the hint on its line
int main() {
#ifdef SKINCTL_RIGHT
  return 0;
#else
  return missing;  // the hint on its line
#endif
}
