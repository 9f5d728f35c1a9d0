import "terrella";
