// expect: missing
int main() {
  return missing;
}
