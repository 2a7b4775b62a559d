import mpmath as mp, numpy as np, sys
mp.mp.dps = 50
def fit(f, lo, hi, m, n, fwd=lambda x:x, inv=lambda x:x, nodes=70, its=6):
    a,b = fwd(mp.mpf(lo)), fwd(mp.mpf(hi))
    xs=[inv((a+b)/2+(b-a)/2*mp.cos(mp.pi*(mp.mpf(k)+.5)/nodes)) for k in range(nodes)]
    fs=[f(x) for x in xs]
    sc = mp.mpf(hi)
    q=[mp.mpf(1)]+[mp.mpf(0)]*n
    w=[mp.mpf(1)]*nodes
    for it in range(its):
        A=mp.matrix(nodes,m+1+n); B=mp.matrix(nodes,1)
        for i,x in enumerate(xs):
            t=x/sc; Q=sum(q[j]*t**j for j in range(n+1)); d=w[i]/(fs[i]*Q)
            for j in range(m+1): A[i,j]=d*t**j
            for j in range(1,n+1): A[i,m+j]=-d*fs[i]*t**j
            B[i]=d*fs[i]
        s,_=mp.qr_solve(A,B)
        p=[s[j] for j in range(m+1)]; q=[mp.mpf(1)]+[s[m+j] for j in range(1,n+1)]
        P=[c/sc**j for j,c in enumerate(p)]; Q=[c/sc**j for j,c in enumerate(q)]
        e=[abs(sum(c*x**j for j,c in enumerate(P))/sum(c*x**j for j,c in enumerate(Q))/fx-1) for x,fx in zip(xs,fs)]
        mx=max(e)
        print(it, mp.nstr(mx,3), file=sys.stderr)
    # dense check with f64 coefficients
    Pf=[float(c) for c in P]; Qf=[float(c) for c in Q]
    emax=0; ed=0
    for k in range(300):
        x=float(inv(a+(b-a)*k/mp.mpf(299))); fx=f(mp.mpf(x))
        v=sum(mp.mpf(c)*mp.mpf(x)**j for j,c in enumerate(Pf))/sum(mp.mpf(c)*mp.mpf(x)**j for j,c in enumerate(Qf))
        emax=max(emax,abs(v/fx-1))
        h=lambda C: __import__('functools').reduce(lambda s,c:s*x+c, reversed(C), 0.0)
        ed=max(ed,abs(mp.mpf(h(Pf)/h(Qf))/fx-1))
    print('err',mp.nstr(emax,3),'double',mp.nstr(ed,3))
    return Pf,Qf
def emit(name,C):
    print(f"const {name}: [f64; {len(C)}] = [")
    for c in C: print(f"    {c!r},")
    print("];")
def zq(p):  # magnitude for p<=.5
    p=mp.mpf(p)
    if p>mp.mpf('0.499999'): 
        pass
    z=mp.sqrt(2)*mp.erfinv(1-2*p) if p>mp.mpf('1e-3') else None
    if z is None:
        r=mp.sqrt(-2*mp.log(p)); z=r-mp.log(r*mp.sqrt(2*mp.pi))/r
        for _ in range(60):
            Q=mp.erfc(z/mp.sqrt(2))/2; d=mp.exp(-z*z/2)/mp.sqrt(2*mp.pi)
            st=(mp.log(Q)-mp.log(p))*Q/d
            z+=st
            if abs(st)<mp.mpf(10)**-44: break
    return z
def central(s):
    if s<=mp.mpf(10)**-30: return mp.sqrt(2*mp.pi)
    s=mp.mpf(s)
    q=mp.sqrt(s); return mp.sqrt(2)*mp.erfinv(2*q)/q
which=sys.argv[1]; m=int(sys.argv[2]); n=int(sys.argv[3])
if which=='central':
    P,Q=fit(lambda r: central(mp.mpf('0.180625')-r),'0','0.180625',m,n,nodes=50); N='CENTRAL'
if which=='tail':
    P,Q=fit(lambda t: zq(mp.exp(-(t+mp.mpf(1.6))**2)),'0','4.9',m,n,nodes=60); N='TAIL'
if which=='far':
    P,Q=fit(lambda t: zq(mp.exp(-(t+mp.mpf(6.0))**2)),'0','21.4',m,n,nodes=60); N='FAR'
if which=='mills':
    P,Q=fit(lambda t: mp.exp(t*t/2)*mp.erfc(t/mp.sqrt(2))/2,'0','39',m,n,fwd=lambda t:t/(t+3),inv=lambda y:3*y/(1-y),nodes=80); N='MILLS'
emit(N+'_NUMERATOR',P); emit(N+'_DENOMINATOR',Q)
