// expect: frames differ
int main() {
#ifdef SKINCTL_RIGHT
  return 0;
}
#else
  return missing;  // the hint stands in the second error only
}
int twice() {
  return absent;  // frames differ
}
#endif
