// expect: missing.*the hint on its line
int main() {
  return missing;  // the hint on its line
}
