// expect: frames differ
int main() {
  return missing;  // the hint stands in the second error only
}
int twice() {
  return absent;  // frames differ
}
